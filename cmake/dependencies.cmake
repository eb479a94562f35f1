# Every third-party package in one place; licences and versions are in third_party_notes/.

# rosefusion_require(NAME PACKAGE OLDEST [ARGUMENTS...]): finds NAME, of Debian's PACKAGE, or says what to install. The
# version is compared here, because some packages refuse to be asked for an older one than their own.
macro(rosefusion_require name package oldest)
  find_package(${name} QUIET ${ARGN})
  if(NOT ${name}_FOUND)
    message(FATAL_ERROR "rosefusion needs ${name} ${oldest}, and CMake found none; install the package ${package} "
                        "(bash apps/install_packages.sh installs all) or name its prefix with -DCMAKE_PREFIX_PATH=.")
  elseif(${name}_VERSION AND "${${name}_VERSION}" VERSION_LESS "${oldest}")
    message(FATAL_ERROR "rosefusion needs ${name} ${oldest} or later, and CMake found ${${name}_VERSION}; install a newer "
                        "${package} or name another prefix with -DCMAKE_PREFIX_PATH=.")
  endif()
endmacro()
# rosefusion_require_program(VARIABLE NAME PACKAGE)
function(rosefusion_require_program variable name package)
  find_program(${variable} ${name})
  if(NOT ${variable})
    message(FATAL_ERROR "rosefusion needs the program ${name}; install the package ${package} (bash apps/install_packages.sh "
                        "installs all) or name it with -D${variable}=.")
  endif()
endfunction()
# rosefusion_require_module(VARIABLE MODULE PACKAGE): of pkg-config; makes PkgConfig::VARIABLE.
macro(rosefusion_require_module variable module package)
  pkg_check_modules(${variable} QUIET IMPORTED_TARGET ${module})
  if(NOT ${variable}_FOUND)
    message(FATAL_ERROR "rosefusion needs ${module}, and pkg-config knows none; install the package ${package} "
                        "(bash apps/install_packages.sh installs all).")
  endif()
endmacro()

find_package(Threads REQUIRED)
rosefusion_require(Vulkan libvulkan-dev 1.3.239)
rosefusion_require(Eigen3 libeigen3-dev 3.3 NO_MODULE)
rosefusion_require(glm libglm-dev "")
rosefusion_require(spdlog libspdlog-dev "")
rosefusion_require(nlohmann_json nlohmann-json3-dev 3.9)
rosefusion_require(yaml-cpp libyaml-cpp-dev "")
rosefusion_require(PkgConfig pkg-config "")
rosefusion_require_module(SPIRV_CROSS spirv-cross-c-shared libspirv-cross-c-shared-dev)
rosefusion_require_program(GLSLANG_VALIDATOR glslangValidator glslang-tools)
rosefusion_require_program(SPIRV_VAL spirv-val spirv-tools)
set(OPENCV_PARTS core)
if(ROSEFUSION_APPS)
  list(APPEND OPENCV_PARTS imgproc imgcodecs calib3d)
  rosefusion_require(CLI11 libcli11-dev "")
  rosefusion_require(nanoflann libnanoflann-dev "")
  rosefusion_require(embree libembree-dev 3)
  rosefusion_require(assimp libassimp-dev "")
  # Of recordings.
  rosefusion_require_module(LZ4 liblz4 liblz4-dev)
  rosefusion_require_module(ZSTD_FRAMES libzstd libzstd-dev)
  rosefusion_require_module(SQLITE sqlite3 libsqlite3-dev)
  rosefusion_require_module(ZLIB_STREAMS zlib zlib1g-dev)
  rosefusion_require_module(ZIP libzip libzip-dev)
  # Of exported meshes and pages.
  rosefusion_require(meshoptimizer libmeshoptimizer-dev "")
endif()
include(cmake/opencv.cmake)
if(ROSEFUSION_TESTS)
  rosefusion_require(GTest libgtest-dev "")
  find_package(benchmark QUIET)  # for bench_host, which is left out without it
endif()
