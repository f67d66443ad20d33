# SPDX-License-Identifier: Apache-2.0
# Files that Debian's policy requires of a package in addition to what is installed: compressed manual pages, a
# changelog, the copyright file, and overrides of lintian's false positives. cpack runs this script before it packs.
if(NOT CPACK_GENERATOR STREQUAL "DEB")
  return()
endif()
file(GLOB compressed ${CPACK_TEMPORARY_DIRECTORY}/*/usr/share/man/man1/*.1)
foreach(page ${compressed})
  file(READ ${page} text)
  if(text MATCHES "^\\.so (.*)\n$")
    file(WRITE ${page} ".so ${CMAKE_MATCH_1}.gz\n")
  endif()
endforeach()
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(GLOB folders ${CPACK_TEMPORARY_DIRECTORY}/*/usr/share/doc/*)
foreach(folder ${folders})
  get_filename_component(package ${folder} NAME)
  file(WRITE ${folder}/changelog "${package} (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium\n\n  * See CHANGELOG.md.\n\n\
 -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
  list(APPEND compressed ${folder}/changelog)
  file(WRITE ${folder}/copyright "Copyright: ${CPACK_PACKAGE_VENDOR}\n\nLicensed under the Apache License, Version 2.0; on \
Debian systems see\n/usr/share/common-licenses/Apache-2.0.\n")
  if(package STREQUAL "understudy")
    file(WRITE ${folder}/../../lintian/overrides/understudy "\
# They hold no code: names that the loader asks for, and what they depend on.\n\
understudy: library-not-linked-against-libc *\n\
# cpack writes these scripts.\n\
understudy: maintscript-calls-ldconfig *\n")
  endif()
endforeach()
if(compressed)
  execute_process(COMMAND gzip -9n ${compressed} COMMAND_ERROR_IS_FATAL ANY)
endif()
