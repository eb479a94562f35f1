# What is installed beside programs, library and Python module, which are installed where they are made.
# The presets are in the program too, and lie here to be copied and changed.
if(ROSEFUSION_APPS)
  install(DIRECTORY apps/presets/ DESTINATION ${CMAKE_INSTALL_DATADIR}/rosefusion/presets COMPONENT rosefusion-program
          FILES_MATCHING PATTERN *.yaml)
endif()
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT rosefusion-program)
install(DIRECTORY third_party_notes DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT rosefusion-program)
