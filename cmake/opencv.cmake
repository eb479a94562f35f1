# OpenCV's core, imgproc and imgcodecs. Debian ships OpenCVConfig.cmake only with all of OpenCV (libopencv-dev, half a
# gigabyte of dependencies), so that the three small -dev packages are found by hand where it is absent.
find_package(OpenCV QUIET COMPONENTS core imgproc imgcodecs)
if(NOT OpenCV_FOUND)
  find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
  foreach(part core imgproc imgcodecs)
    find_library(OPENCV_${part}_LIBRARY opencv_${part} REQUIRED)
    add_library(opencv_${part} UNKNOWN IMPORTED)
    set_target_properties(opencv_${part} PROPERTIES
      IMPORTED_LOCATION "${OPENCV_${part}_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${OPENCV_INCLUDE_DIR}")
  endforeach()
  set_property(TARGET opencv_imgproc opencv_imgcodecs APPEND PROPERTY INTERFACE_LINK_LIBRARIES opencv_core)
endif()
