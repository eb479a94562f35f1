# rosefusion_library(NAME SOURCES ... LINK ...): one static library per folder, with the project's warnings.
add_library(rosefusion_options INTERFACE)
target_compile_options(rosefusion_options INTERFACE -Wall -Wextra -Wshadow -Wno-missing-field-initializers)
if(ROSEFUSION_WARNINGS_AS_ERRORS)
  target_compile_options(rosefusion_options INTERFACE -Werror)
endif()
if(ROSEFUSION_SANITIZE)
  target_compile_options(rosefusion_options INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=undefined
                                                     -fno-omit-frame-pointer)
  target_link_options(rosefusion_options INTERFACE -fsanitize=address,undefined)
endif()

function(rosefusion_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PUBLIC rosefusion_options ${ARG_LINK} PRIVATE ${ARG_PRIVATE_LINK})
endfunction()
