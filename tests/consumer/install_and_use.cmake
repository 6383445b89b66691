# cmake -DBUILD=... -DSOURCE=... -DWORK=... -DREADME=... -DMAP=... -DCONFIG=... -DCXX=... -DCXX_FLAGS=...
#       -P install_and_use.cmake
# Installs wavefog into a fresh prefix, builds tests/consumer against it in a fresh directory, runs
# what comes out.
function(run)
    execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --config ${CONFIG} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -G Ninja -S ${SOURCE} -B ${WORK}/build -DCMAKE_BUILD_TYPE=${CONFIG}
    -DCMAKE_PREFIX_PATH=${WORK}/prefix -DREADME=${README} -DCMAKE_CXX_COMPILER=${CXX}
    "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}")
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/consumer)
run(${WORK}/build/readme_example ${MAP})
if(EXISTS ${WORK}/prefix/bin/wavefog)
    run(${WORK}/prefix/bin/wavefog --version)
endif()
