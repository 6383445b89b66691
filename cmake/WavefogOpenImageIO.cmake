# Finds OpenImageIO. Debian 12's package names an include directory of OpenCV that it does not bring
# and that its headers do not need; CMake would refuse to use the target.
find_package(OpenImageIO REQUIRED)
get_target_property(include_directories OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
set(existing_directories)
foreach(directory IN LISTS include_directories)
    if(EXISTS "${directory}")
        list(APPEND existing_directories "${directory}")
    endif()
endforeach()
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${existing_directories}")
unset(include_directories)
unset(existing_directories)
