// Recordings as the command line reads them, for the Python module.
#pragma once
#include <pybind11/pybind11.h>

/// Adds rosefusion.load().
void addRecordings(pybind11::module_& m);
