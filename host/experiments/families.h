// The experiments' definitions, one file each or per family.
#pragma once
#include "host/experiments/experiment.h"

namespace rosefusion {

Experiment tsdfNormalisation();
Experiment optimisers();
Experiment rescaling();
Experiment multires();
Experiment complexity();
Experiment accuracy();
Experiment frames();
Experiment surfaces();
Experiment inside();
Experiment gallery();
Experiment speedLimit();

}  // namespace rosefusion
