# What is installed where, and the Debian package of it: cpack -G DEB in the build's folder. Its scripts, udev rules
# and limits lie in cmake/debian.
set(CMAKE_INSTALL_MESSAGE LAZY)
install(TARGETS palpate RUNTIME DESTINATION bin)
install(TARGETS palpate_sample LIBRARY DESTINATION lib/palpate)
install(TARGETS palpate_figures RUNTIME DESTINATION lib/palpate)
install(DIRECTORY protocols/library/ DESTINATION share/palpate/protocols FILES_MATCHING PATTERN *.toml)
install(DIRECTORY engine/device/firmware DESTINATION share/palpate/engine/device
        FILES_MATCHING PATTERN *.c PATTERN *.h PATTERN *.sh)
install(FILES data/trace/read_trace.py data/trace/read_trace.R DESTINATION share/palpate/data/trace)
install(DIRECTORY examples DESTINATION share/palpate)
install(DIRECTORY docs DESTINATION share/doc/palpate)
install(FILES README.md CHANGELOG.md DESTINATION share/doc/palpate)
# Without links to what only the sources hold.
install(CODE [=[
    set(doc "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/share/doc/palpate")
    file(GLOB pages "${doc}/*.md" "${doc}/docs/*.md")
    execute_process(COMMAND sed -Ei [==[s,\[([^][]*)\]\((\.\./[a-z]|data/|LICENSE)[^)]*\),\1,g]==] ${pages}
        COMMAND_ERROR_IS_FATAL ANY)]=])
install(FILES LICENSE DESTINATION share/doc/palpate RENAME copyright)
install(FILES data/page/uplot/LICENSE DESTINATION share/doc/palpate RENAME copyright.uPlot)  # in every page of a trial
install(FILES cmake/debian/70-palpate.rules DESTINATION lib/udev/rules.d)
install(FILES cmake/debian/limits.conf DESTINATION /etc/security/limits.d RENAME palpate.conf)

# The program itself says what its commands are: these cannot go stale.
install(CODE "
    set(share \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/share\")
    file(MAKE_DIRECTORY \"\${share}/man/man1\" \"\${share}/bash-completion/completions\")
    execute_process(COMMAND \"$<TARGET_FILE:palpate>\" words man
        OUTPUT_FILE \"\${share}/man/man1/palpate.1\" COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND \"$<TARGET_FILE:palpate>\" words bash
        OUTPUT_FILE \"\${share}/bash-completion/completions/palpate\" COMMAND_ERROR_IS_FATAL ANY)
    foreach(kind protocol procedure scene calibration observer)
        file(MAKE_DIRECTORY \"\${share}/palpate/schema\")
        execute_process(COMMAND \"$<TARGET_FILE:palpate>\" words schema --of \${kind}
            OUTPUT_FILE \"\${share}/palpate/schema/\${kind}.json\" COMMAND_ERROR_IS_FATAL ANY)
    endforeach()
    execute_process(COMMAND gzip -9nf \"\${share}/man/man1/palpate.1\" COMMAND_ERROR_IS_FATAL ANY)")

file(WRITE ${PROJECT_BINARY_DIR}/debian/conffiles "/etc/security/limits.d/palpate.conf\n")
set(CPACK_GENERATOR DEB)
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_CONTACT "The palpate authors <palpate@localhost>")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "acl, fonts-dejavu-core, passwd")
# What is loaded when it is needed: a machine that only analyses goes without.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "bash-completion, libmicrohttpd12 | libmicrohttpd12t64, libpq5, libsdl2-2.0-0, \
libsdl2-ttf-2.0-0, sqlite3, systemd, udev")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "avrdude, gcc-avr, avr-libc, binutils-avr, rt-tests")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/debian/postinst
    ${PROJECT_SOURCE_DIR}/cmake/debian/postrm ${PROJECT_BINARY_DIR}/debian/conffiles)
include(CPack)
