# SPDX-License-Identifier: Apache-2.0
# cmake --install: component runtime holds what users need; component development holds what is needed to build programs
# that cast rays, join the nodes or add a unit to the chain. Programs locate everything relative to themselves, so that
# the prefix can be moved.
# Installed targets are built by name, without tests and benchmarks.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)
include(CMakePackageConfigHelpers)
include(${CMAKE_CURRENT_LIST_DIR}/public_headers.cmake)

set(programs understudy understudy-view understudy-viewer)
if(TARGET understudy-node)
  list(APPEND programs understudy-node)
endif()
install(TARGETS ${programs} COMPONENT runtime)
get_property(stubs GLOBAL PROPERTY UNDERSTUDY_STUBS)
install(TARGETS understudy-entry understudy-core understudy-audit LIBRARY DESTINATION ${UNDERSTUDY_INSTALL_LIBRARIES}
  COMPONENT runtime NAMELINK_SKIP)
install(TARGETS ${stubs} LIBRARY DESTINATION ${UNDERSTUDY_INSTALL_LIBRARIES}/entry COMPONENT runtime)
foreach(component runtime development)
  set(suffix $<$<STREQUAL:${component},development>:-dev>)
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/understudy${suffix} RENAME copyright COMPONENT ${component})
endforeach()
install(FILES apps/understudy/study/study_page.py apps/bench/vtk_mappers.py DESTINATION ${UNDERSTUDY_INSTALL_DATA}
  COMPONENT runtime)
set(pages ${CMAKE_BINARY_DIR}/share)
install(FILES ${pages}/man/man1/understudy.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)
foreach(program ${programs})
  if(NOT program STREQUAL "understudy")
    file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/man/${program}.1 CONTENT ".so man1/understudy.1\n")
    install(FILES ${CMAKE_CURRENT_BINARY_DIR}/man/${program}.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)
  endif()
endforeach()
foreach(completion bash-completion/completions/understudy zsh/vendor-completions/_understudy
    fish/vendor_completions.d/understudy.fish)
  get_filename_component(folder ${completion} DIRECTORY)
  install(FILES ${pages}/${completion} DESTINATION ${CMAKE_INSTALL_DATADIR}/${folder} COMPONENT runtime)
endforeach()
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)

# Components of find_package(Understudy), lowest first: each needs those before it.
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Understudy)
set(headers_folder ${CMAKE_INSTALL_INCLUDEDIR}/understudy)

# install_component(NAME TARGETS EXPORTED_NAME TARGET... HEADERS HEADER...)
function(install_component name)
  cmake_parse_arguments(ARG "" "" "TARGETS;HEADERS" ${ARGN})
  while(ARG_TARGETS)
    list(POP_FRONT ARG_TARGETS exported target)
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${exported})
    target_include_directories(${target} INTERFACE $<INSTALL_INTERFACE:${headers_folder}>)
    target_compile_features(${target} INTERFACE cxx_std_20)
    install(TARGETS ${target} EXPORT Understudy-${name} ARCHIVE COMPONENT development)
  endwhile()
  install(EXPORT Understudy-${name} NAMESPACE Understudy:: DESTINATION ${package_folder} COMPONENT development)
  public_headers(headers ${ARG_HEADERS})
  foreach(header ${headers})
    get_filename_component(folder ${header} DIRECTORY)
    install(FILES ${header} DESTINATION ${headers_folder}/${folder} COMPONENT development)
  endforeach()
  foreach(header ${headers_GENERATED})
    get_filename_component(folder ${header} DIRECTORY)
    install(FILES ${CMAKE_BINARY_DIR}/generated/${header} DESTINATION ${headers_folder}/${folder} COMPONENT development)
  endforeach()
endfunction()

install_component(raycast
  TARGETS raycast understudy_volume volume_export understudy_volume_export files understudy_volume_file
  HEADERS volume/brick/brick_store.h volume/brick/histogram.h volume/file/file_error.h volume/opening/open_volume.h
    volume/frame_counts.h volume/image.h volume/matrix.h volume/orbit_camera.h volume/raycast/ray_caster.h
    volume/reference/pixel_integral.h volume/request.h volume/transfer_control_points.h)
install_component(plugin TARGETS plugin understudy_unit_plugin HEADERS spu/plugin/unit_plugin.h)
set(compositor_headers compositor/blend.h compositor/rendered.h compositor/service.h compositor/exchange/exchange.h
  compositor/exchange/thread_communicator.h compositor/node/node.h)
if(MPI_CXX_FOUND)
  list(APPEND compositor_headers compositor/exchange/mpi_communicator.h)
endif()
install_component(compositor
  TARGETS transport understudy_transport logging understudy_logging compositor understudy_compositor scene understudy_scene loading
    understudy_loading pixels understudy_pixels nodes understudy_exchange
  HEADERS ${compositor_headers})
# A glslang that is built here is not installed.
if(NOT TARGET glslang)
  install_component(spu
    TARGETS dispatch understudy_dispatch report understudy_report program_analysis understudy_program_analysis spu
      understudy_spu
    HEADERS spu/unit_description.h spu/chain.h spu/driver/driver.h spu/options.h spu/registry/assemble.h
      spu/track/share_group.h)
endif()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/UnderstudyConfig.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/UnderstudyConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/UnderstudyConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/UnderstudyConfig.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/UnderstudyConfigVersion.cmake DESTINATION ${package_folder} COMPONENT development)
file(RELATIVE_PATH prefix_from_pkgconfig /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(${CMAKE_CURRENT_LIST_DIR}/understudy-raycast.pc.in ${CMAKE_CURRENT_BINARY_DIR}/understudy-raycast.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/understudy-raycast.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
  COMPONENT development)

# The interpreter's search path: Debian has one folder for all versions of Python 3.
if(TARGET understudy_python)
  if(EXISTS /etc/debian_version)
    set(python_packages lib/python3/dist-packages)
  else()
    set(python_packages ${CMAKE_INSTALL_LIBDIR}/python${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}/site-packages)
  endif()
  set(UNDERSTUDY_INSTALL_PYTHON ${python_packages} CACHE STRING "Where the Python module is installed, below the prefix")
  set(modulefile_python "prepend-path PYTHONPATH        [file join $prefix ${UNDERSTUDY_INSTALL_PYTHON}]")
  install(TARGETS understudy_python LIBRARY DESTINATION ${UNDERSTUDY_INSTALL_PYTHON}/understudy COMPONENT python)
  install(FILES apps/python/understudy/__init__.py DESTINATION ${UNDERSTUDY_INSTALL_PYTHON}/understudy COMPONENT python)
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-understudy RENAME copyright COMPONENT python)
endif()

# For sites that provide programs by `module load`. Packages, which install into the system's prefix, omit it.
set(modulefiles_folder ${CMAKE_INSTALL_DATADIR}/modulefiles/understudy)
file(RELATIVE_PATH prefix_from_modulefile /prefix/${modulefiles_folder} /prefix)
configure_file(${CMAKE_CURRENT_LIST_DIR}/modulefile.in ${CMAKE_CURRENT_BINARY_DIR}/modulefile @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/modulefile DESTINATION ${modulefiles_folder} RENAME ${PROJECT_VERSION}
  COMPONENT modulefile)

include(${CMAKE_CURRENT_LIST_DIR}/packages.cmake)
