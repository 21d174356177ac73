# Installation and Debian package: ninja -C build/release package
if(RAYWATT_SANITIZE)
  return()
endif()
include(GNUInstallDirs)

# Shell completion and the manual page are generated from the program's options.
set(described ${CMAKE_BINARY_DIR}/described)
set(descriptions)
foreach(file "bash;completion;bash" "_raywatt;completion;zsh" "fish;completion;fish" "raywatt.1;man")
  list(POP_FRONT file name)
  add_custom_command(OUTPUT ${described}/${name}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${described}
    COMMAND raywatt ${file} > ${described}/${name} DEPENDS raywatt VERBATIM)
  list(APPEND descriptions ${described}/${name})
endforeach()
# Packages need compressed texts without timestamps.
foreach(file "raywatt.1;${described}/raywatt.1" "changelog;${CMAKE_CURRENT_LIST_DIR}/changelog")
  list(GET file 0 name)
  list(GET file 1 text)
  add_custom_command(OUTPUT ${described}/${name}.gz COMMAND gzip -9nc ${text} > ${described}/${name}.gz
    DEPENDS ${text} VERBATIM)
  list(APPEND descriptions ${described}/${name}.gz)
endforeach()
add_custom_target(descriptions ALL DEPENDS ${descriptions})

set(share ${CMAKE_INSTALL_DATADIR})
install(TARGETS raywatt)
# The program's module path. A subfolder, because CPack would run ldconfig for libraries in lib/raywatt.
install(TARGETS raywatt_search raywatt_images LIBRARY DESTINATION lib/raywatt/modules)
install(DIRECTORY configs traces/workloads tests/validation/published DESTINATION ${share}/raywatt)
install(DIRECTORY tools/python DESTINATION ${share}/raywatt PATTERN __pycache__ EXCLUDE)
foreach(file page.js page.css libraries.js licences.txt)  # missing without npm
  install(FILES ${CMAKE_BINARY_DIR}/report_page/${file} DESTINATION ${share}/raywatt/report_page OPTIONAL)
endforeach()
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} PATTERN refresh EXCLUDE)
install(FILES README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES cmake/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${CMAKE_BINARY_DIR}/report_page/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR} OPTIONAL)  # with the libraries' notices
install(FILES ${described}/changelog.gz DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${described}/raywatt.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${described}/bash DESTINATION ${share}/bash-completion/completions RENAME raywatt)
install(FILES ${described}/_raywatt DESTINATION ${share}/zsh/vendor-completions)
install(FILES ${described}/fish DESTINATION ${share}/fish/vendor_completions.d RENAME raywatt.fish)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME raywatt)
set(CPACK_PACKAGE_CONTACT "Raywatt maintainers <raywatt@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "simulator of a mobile ray-tracing GPU")
set(CPACK_PACKAGE_DESCRIPTION
"Raywatt reports cycles, rays, energy and performance per watt of a
ray-tracing GPU of the SGRT class: fixed-function traversal and intersection
units, programmable shader cores, tile buffers, caches and LPDDR memory, each
described by keys of a YAML file. It renders glTF scenes by full or adaptive
sampling.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "fonts-dejavu-core")  # labels of heat maps; libraries are added by shlibdeps
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "python3-pandas, python3-matplotlib, python3-zstandard")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
include(CPack)
