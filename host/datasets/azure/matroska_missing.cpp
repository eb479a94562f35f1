// Where libmatroska was not found when the program was built.
#include "host/core/error.h"
#include "host/datasets/azure/matroska.h"

namespace rosefusion::datasets {

MatroskaFile readMatroska(const std::filesystem::path& file) {
  throw InputError(file.string() +
                   ": this program was built without libmatroska, which reads .mkv; install libebml-dev and "
                   "libmatroska-dev and build it again.");
}

}  // namespace rosefusion::datasets
