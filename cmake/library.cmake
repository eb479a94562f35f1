# The library that is installed for others (host/public): all parts in one file, static or shared as BUILD_SHARED_LIBS
# says, exporting no more than those headers. The tests want the other kind too; it is installed only by the name of
# its component, rosefusion-static or rosefusion-shared.
set(parts core swarm settings shaders engine tracking mapping relocalisation baselines loop_closure slam embedding)
# By the names that linkers know: who links the static library needs these files, and none of their headers.
set(used opencv_core yaml-cpp spirv-cross-c-shared ${CMAKE_DL_LIBS})
if(ROSEFUSION_LOOP_CLOSURE)
  list(APPEND parts codec)
  list(APPEND used ceres glog zstd)
endif()
set(objects "")
set(targets "")
foreach(part ${parts})
  list(APPEND objects $<TARGET_OBJECTS:rosefusion_${part}>)
  list(APPEND targets rosefusion_${part})
endforeach()
# The static library is one object in which only what the shared one exports is global. Else the templates and inline
# functions of Eigen, glm, OpenCV and the others would be one with the application's, which may have been compiled for
# other alignments, processors or versions. Elsewhere than with GNU's tools it is the parts' objects as they are.
set(static_objects ${objects})
if(CMAKE_OBJCOPY AND CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang" AND NOT APPLE AND NOT WIN32)
  set(merged ${PROJECT_BINARY_DIR}/merged.o)
  set(static_objects ${PROJECT_BINARY_DIR}/rosefusion.o)
  add_custom_command(OUTPUT ${static_objects}
    COMMAND ${CMAKE_LINKER} -r --force-group-allocation -o ${merged} ${objects}
    COMMAND ${CMAKE_OBJCOPY} --localize-hidden --wildcard --keep-global-symbol=_ZN*10rosefusion* --keep-global-symbol=_ZT*N10rosefusion5ErrorE
            ${merged} ${static_objects}
    DEPENDS ${targets} ${objects} COMMAND_EXPAND_LISTS VERBATIM)
  set_source_files_properties(${static_objects} PROPERTIES EXTERNAL_OBJECT ON)
endif()
if(BUILD_SHARED_LIBS)
  set(chosen shared)
else()
  set(chosen static)
endif()

foreach(kind static shared)
  set(library rosefusion_library_${kind})
  set(only_by_name "")
  if(NOT kind STREQUAL chosen)
    set(only_by_name EXCLUDE_FROM_ALL)
  endif()
  if(kind STREQUAL "static")
    add_library(${library} STATIC ${static_objects})
  else()
    add_library(${library} SHARED ${objects})
  endif()
  set_target_properties(${library} PROPERTIES OUTPUT_NAME rosefusion EXPORT_NAME rosefusion LINKER_LANGUAGE CXX
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_compile_features(${library} INTERFACE cxx_std_20)
  target_include_directories(${library} INTERFACE "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>"
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/host/public> $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>)
  if(kind STREQUAL "static")
    target_link_libraries(${library} INTERFACE ${used})
  else()
    target_link_libraries(${library} PRIVATE ${used})
    target_compile_definitions(${library} INTERFACE $<$<PLATFORM_ID:Windows>:ROSEFUSION_SHARED>)
    if(NOT WIN32 AND NOT APPLE)  # the linkers of ELF files
      # Templates of the standard library are weak symbols that hidden visibility does not reach.
      target_link_options(${library} PRIVATE -Wl,--as-needed -Wl,--no-undefined
                          "-Wl,--version-script=${PROJECT_SOURCE_DIR}/cmake/library.map")
      set_target_properties(${library} PROPERTIES LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/library.map)
    endif()
  endif()
  if(only_by_name AND NOT ROSEFUSION_TESTS)
    set_target_properties(${library} PROPERTIES EXCLUDE_FROM_ALL ON)
  endif()
endforeach()
# For those who have this folder in their own project (add_subdirectory, FetchContent).
add_library(rosefusion::rosefusion ALIAS rosefusion_library_${chosen})
set(rosefusion_GLSL_DIR ${PROJECT_SOURCE_DIR} CACHE INTERNAL "For glslang's -I: shaders that include shaders/compute/lib/...")

if(NOT ROSEFUSION_INSTALL)
  return()
endif()
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rosefusion)
foreach(kind static shared)
  set(only_by_name "")
  if(NOT kind STREQUAL chosen)
    set(only_by_name EXCLUDE_FROM_ALL)
  endif()
  install(TARGETS rosefusion_library_${kind} EXPORT rosefusion-${kind} COMPONENT rosefusion-${kind} ${only_by_name})
  install(EXPORT rosefusion-${kind} NAMESPACE rosefusion:: DESTINATION ${package_dir}
          COMPONENT rosefusion-${kind} ${only_by_name})
endforeach()

install(DIRECTORY host/public/rosefusion ${PROJECT_BINARY_DIR}/include/rosefusion DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        COMPONENT rosefusion-headers FILES_MATCHING PATTERN *.h)
install(DIRECTORY shaders/compute/lib shaders/compute/interface
        DESTINATION ${CMAKE_INSTALL_DATADIR}/rosefusion/glsl/shaders/compute COMPONENT rosefusion-headers)
configure_package_config_file(cmake/rosefusionConfig.cmake.in ${PROJECT_BINARY_DIR}/rosefusionConfig.cmake
  INSTALL_DESTINATION ${package_dir} PATH_VARS CMAKE_INSTALL_DATADIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/rosefusionConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/rosefusionConfig.cmake ${PROJECT_BINARY_DIR}/rosefusionConfigVersion.cmake
        DESTINATION ${package_dir} COMPONENT rosefusion-headers)
