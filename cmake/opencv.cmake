# Of OpenCV what OPENCV_PARTS says. Debian ships OpenCVConfig.cmake only with all of OpenCV (libopencv-dev, half a
# gigabyte of dependencies), so that the three small -dev packages are found by hand where it is absent.
find_package(OpenCV QUIET COMPONENTS ${OPENCV_PARTS})
if(NOT OpenCV_FOUND)
  find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
  foreach(part ${OPENCV_PARTS})
    find_library(OPENCV_${part}_LIBRARY opencv_${part})
    if(NOT OPENCV_INCLUDE_DIR OR NOT OPENCV_${part}_LIBRARY)
      message(FATAL_ERROR "rosefusion needs OpenCV's ${part}, and CMake found none; install the package libopencv-${part}-dev "
                          "(bash apps/install_packages.sh installs all) or name OpenCV's folder with -DOpenCV_DIR=.")
    endif()
    add_library(opencv_${part} UNKNOWN IMPORTED)
    set_target_properties(opencv_${part} PROPERTIES
      IMPORTED_LOCATION "${OPENCV_${part}_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${OPENCV_INCLUDE_DIR}")
  endforeach()
  foreach(part ${OPENCV_PARTS})
    if(NOT part STREQUAL "core")
      set_property(TARGET opencv_${part} APPEND PROPERTY INTERFACE_LINK_LIBRARIES opencv_core)
    endif()
  endforeach()
endif()
