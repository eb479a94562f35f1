// Plots as PNG files, drawn by gnuplot in a process of its own.
#pragma once
#include <filesystem>
#include <map>
#include <string>

namespace rosefusion {

struct Plot {
  /// gnuplot commands. Terminal, output file, font sizes and colours are already set; `set multiplot` is
  /// allowed.
  std::string commands;
  /// File name to text: the tables that `commands` read by these names, e.g. plot "error.dat" using 1:2.
  std::map<std::string, std::string> tables;
  int width_px = 1600;
  int height_px = 800;
};

/// Draws into `png`, which appears whole or not at all. Throws InputError when gnuplot is not installed or
/// `png` cannot be written, and std::runtime_error with gnuplot's words when it refuses the commands.
void renderPlot(const Plot& plot, const std::filesystem::path& png);

/// `text` as a gnuplot string literal.
std::string plotQuoted(const std::string& text);

}  // namespace rosefusion
