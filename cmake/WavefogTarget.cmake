# wavefog_target(<target>): what every target of ours has in common. Nothing here is global, so a
# project that adds wavefog with add_subdirectory keeps its own flags.
function(wavefog_target target)
    target_compile_features(${target} PUBLIC cxx_std_20)
    set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
    if(WAVEFOG_WARNINGS)
        target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wconversion)
    endif()
    if(WAVEFOG_WERROR)
        target_compile_options(${target} PRIVATE -Werror)
    endif()
    # These two change how Eigen aligns fixed-size matrices, so whoever links us must agree.
    if(WAVEFOG_NATIVE)
        target_compile_options(${target} PUBLIC -march=native)
    endif()
    if(WAVEFOG_SCALAR)
        target_compile_options(${target} PRIVATE -fno-tree-vectorize -fno-tree-slp-vectorize)
        target_compile_definitions(${target} PUBLIC EIGEN_DONT_VECTORIZE)
    endif()
endfunction()

# wavefog_library(<name> SOURCES ...): the library wavefog-<name>, its alias wavefog::<name> and its
# public headers under <name>/include.
function(wavefog_library name)
    cmake_parse_arguments(arg "" "" "SOURCES" ${ARGN})
    add_library(wavefog-${name} STATIC ${arg_SOURCES})
    add_library(wavefog::${name} ALIAS wavefog-${name})
    set_target_properties(wavefog-${name} PROPERTIES EXPORT_NAME ${name})
    target_include_directories(wavefog-${name}
        PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
               $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
        PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
    wavefog_target(wavefog-${name})
endfunction()
