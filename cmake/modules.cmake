# rosefusion_library(NAME SOURCES ... LINK ...): one static library per folder, with the project's warnings and the
# shared precompiled header (Eigen, OpenCV's core, nlohmann-json and spdlog take most of a file's compile time).
add_library(rosefusion_options INTERFACE)
target_compile_features(rosefusion_options INTERFACE cxx_std_20)
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  target_compile_options(rosefusion_options INTERFACE -Wall -Wextra -Wshadow -Wno-missing-field-initializers)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # It sees overruns in inlined standard strings that are none (GCC bug 105651 and kin).
  target_compile_options(rosefusion_options INTERFACE -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow
                                                      -Wno-stringop-overread)
  # Statics of inline functions as weak symbols, which cmake/library.cmake can make local.
  target_compile_options(rosefusion_options INTERFACE -fno-gnu-unique)
endif()
if(ROSEFUSION_WARNINGS_AS_ERRORS)
  target_compile_options(rosefusion_options INTERFACE $<IF:$<CXX_COMPILER_ID:MSVC>,/WX,-Werror>)
endif()
if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES ccache AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(rosefusion_options INTERFACE -fpch-preprocess)  # lets ccache see through the header
endif()
set(ROSEFUSION_UNFUSED $<$<NOT:$<CXX_COMPILER_ID:MSVC>>:-ffp-contract=off>)  # MSVC does not fuse unless told to

# rosefusion_properties(TARGETS...): what every target has that is compiled here. Whoever shares a precompiled header must
# agree in these. Hidden is all but what host/public marks.
function(rosefusion_properties)
  set_target_properties(${ARGN} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON
                        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endfunction()

if(ROSEFUSION_SANITIZE)
  set(sanitizers address,undefined)
  # Checks at every access through a pointer take two fifths of the compile time; what they could find, a bad address, the
  # address sanitizer finds too.
  set(left_out -fno-sanitize=null,alignment,object-size,vptr)
  if(ROSEFUSION_SANITIZE STREQUAL "thread")
    set(sanitizers thread)
    set(left_out "")
  endif()
  target_compile_options(rosefusion_options INTERFACE -fsanitize=${sanitizers} -fno-sanitize-recover=undefined ${left_out}
                                                     -fno-omit-frame-pointer)
  target_link_options(rosefusion_options INTERFACE -fsanitize=${sanitizers})
  if(NOT ROSEFUSION_SANITIZE STREQUAL "thread")
    add_library(rosefusion_keep_loaded OBJECT tests/keep_loaded.cpp)
    rosefusion_properties(rosefusion_keep_loaded)
    target_sources(rosefusion_options INTERFACE
      $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:$<TARGET_OBJECTS:rosefusion_keep_loaded>>)
  endif()
endif()

if(ROSEFUSION_FUZZ)
  target_compile_options(rosefusion_options INTERFACE -fsanitize=fuzzer-no-link)
endif()

add_library(rosefusion_common INTERFACE)
target_include_directories(rosefusion_common INTERFACE ${PROJECT_SOURCE_DIR})
target_link_libraries(rosefusion_common INTERFACE rosefusion_options Eigen3::Eigen opencv_core
                                                  nlohmann_json::nlohmann_json spdlog::spdlog Threads::Threads)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/pch.cpp CONTENT "// Empty.\n")  # not touched when it is there already
add_library(rosefusion_pch OBJECT ${PROJECT_BINARY_DIR}/pch.cpp)
rosefusion_properties(rosefusion_pch)
target_link_libraries(rosefusion_pch PRIVATE rosefusion_common)
target_precompile_headers(rosefusion_pch PRIVATE
  <Eigen/Geometry> <nlohmann/json.hpp> <opencv2/core.hpp> <spdlog/spdlog.h>
  <algorithm> <array> <filesystem> <fstream> <functional> <map> <memory> <optional> <sstream> <string> <vector>)

function(rosefusion_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC rosefusion_common ${ARG_LINK} PRIVATE ${ARG_PRIVATE_LINK})
  target_precompile_headers(${name} REUSE_FROM rosefusion_pch)
  rosefusion_properties(${name})
endfunction()
