// Ctrl-C during long work: the first asks it to end and what is done to be written, the second gives up.
#pragma once

namespace rosefusion::cli {

/// From here on Ctrl-C (and SIGTERM) is asked for with interrupted().
void catchInterrupts();
bool interrupted();

}  // namespace rosefusion::cli
