#include "host/evaluation/plot.h"

#include <sstream>
#include <stdexcept>

#include "host/core/error.h"
#include "host/core/file_io.h"
#include "host/core/number_text.h"
#include "host/core/system.h"

namespace rosefusion {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& file) {
  std::string bytes;
  if (readBytes(file, bytes)) bytes.clear();
  return bytes;
}

void write(const fs::path& file, const std::string& text) {
  if (writeBytes(file, text))
    throw InputError(file.string() +
                     ": cannot be written; free some space or point TMPDIR to another folder.");
}

constexpr const char* kStyle = R"(set encoding utf8
set grid linecolor rgb "#bbbbbb" linewidth 1
set border linecolor rgb "#444444"
set tics textcolor rgb "#222222"
set linetype 1 linecolor rgb "#222222" linewidth 2
set linetype 2 linecolor rgb "#d1495b" linewidth 2
set linetype 3 linecolor rgb "#00798c" linewidth 2
set linetype 4 linecolor rgb "#edae49" linewidth 2
)";

}  // namespace

void renderPlot(const Plot& plot, const fs::path& png) {
  const ScratchFolder folder("plot");
  for (const auto& [name, text] : plot.tables) write(folder.path() / name, text);
  TextStream script;
  script << "set terminal pngcairo size " << plot.width_px << ',' << plot.height_px
         << " font \"sans,15\" noenhanced background rgb \"white\"\n"
         << "cd " << plotQuoted(folder.path().string()) << "\nset output 'plot.png'\n"
         << kStyle << plot.commands << "\nunset multiplot\nset output\n";
  write(folder.path() / "script.gp", script.str());

  const int status =
      runProgram({"gnuplot", (folder.path() / "script.gp").string()}, folder.path() / "log.txt");
  if (status == 127)
    throw InputError(png.string() +
                     ": cannot be drawn because gnuplot is not installed; install it (Debian and "
                     "Ubuntu: gnuplot-nox) or leave the plot out.");
  const std::string image = contents(folder.path() / "plot.png");
  if (status != 0 || image.empty())
    throw std::runtime_error(png.string() +
                             ": gnuplot could not draw it: " + contents(folder.path() / "log.txt"));
  writeFileAtomically(png, image);
}

std::string plotQuoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c == '\n' ? ' ' : c;
  }
  return quoted + '"';
}

}  // namespace rosefusion
