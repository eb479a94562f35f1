# Writes commit.cpp where the commit has changed since: cmake -DFROM=FOLDER -DTO=FILE -P commit.cmake, at every build.
get_filename_component(here ${CMAKE_CURRENT_LIST_DIR} ABSOLUTE)
set(COMMIT "not told")
find_program(GIT git)
if(GIT)
  # An unpacked archive may lie in somebody else's repository.
  execute_process(COMMAND ${GIT} -C ${FROM} rev-parse --show-toplevel OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  file(REAL_PATH ${FROM} from)
  if(top AND top STREQUAL from)
    execute_process(COMMAND ${GIT} -C ${FROM} rev-parse --short=12 HEAD OUTPUT_VARIABLE COMMIT
                    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    execute_process(COMMAND ${GIT} -C ${FROM} status --porcelain --untracked-files=no OUTPUT_VARIABLE changes ERROR_QUIET)
    if(changes)
      string(APPEND COMMIT ", changed")
    endif()
  endif()
endif()
configure_file(${here}/commit.cpp.in ${TO} @ONLY)
