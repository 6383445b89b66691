# Installs the libraries, their headers, the shaders, the command and a package config, so that
# another project can say find_package(wavefog) and link wavefog::wavelet, ::fogmap and ::gpu.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/wavefog)

install(TARGETS wavefog-wavelet wavefog-fogmap wavefog-gpu EXPORT wavefogTargets)
foreach(module wavelet fogmap gpu)
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/${module}/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/shaders/ DESTINATION ${CMAKE_INSTALL_DATADIR}/wavefog/shaders)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(WAVEFOG_BUILD_CLI)
    install(TARGETS wavefog)
endif()

install(EXPORT wavefogTargets NAMESPACE wavefog:: DESTINATION ${package_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/wavefogConfig.cmake.in
    ${PROJECT_BINARY_DIR}/wavefogConfig.cmake
    INSTALL_DESTINATION ${package_dir}
    PATH_VARS CMAKE_INSTALL_DATADIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/wavefogConfigVersion.cmake
    COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/wavefogConfig.cmake
              ${PROJECT_BINARY_DIR}/wavefogConfigVersion.cmake
        DESTINATION ${package_dir})
