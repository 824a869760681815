# Fetches the page's packages where they are not there yet, and builds the page. Where they cannot be
# fetched the page is left empty, with a warning, and the rest of the build goes on.
file(SHA256 ${WEB}/package-lock.json wanted)
set(stamp ${WEB}/node_modules/.octavo-lock)
set(there "")
if(EXISTS ${stamp})
    file(READ ${stamp} there)
endif()
get_filename_component(folder ${PAGE} DIRECTORY)
file(MAKE_DIRECTORY ${folder})

# Two build folders may share web/node_modules.
file(LOCK ${WEB}/.npm-lock GUARD PROCESS TIMEOUT 600)
if(NOT there STREQUAL wanted)
    execute_process(COMMAND ${NPM} ci --loglevel=error WORKING_DIRECTORY ${WEB} RESULT_VARIABLE failed)
    if(failed)
        message(WARNING "npm cannot fetch the packages of web/: octavo view will have no page. "
                        "Build again once it can.")
        file(WRITE ${PAGE} "")
        return()
    endif()
    file(WRITE ${stamp} ${wanted})
endif()
execute_process(COMMAND ${NPM} run --silent build -- --logLevel warn --outDir ${folder} --emptyOutDir
                WORKING_DIRECTORY ${WEB} RESULT_VARIABLE failed)
if(failed)
    file(REMOVE ${PAGE})
    message(FATAL_ERROR "The viewer's page does not build")
endif()
