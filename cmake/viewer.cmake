# The viewer's page, one HTML file, which the octavo command carries inside it. Needs Node.js and npm;
# without them everything else is built, and `octavo view` says that it has no page.
option(OCTAVO_VIEWER "Build the viewer's page where Node.js and npm are there" ON)

set(OCTAVO_VIEWER_PAGE ${PROJECT_BINARY_DIR}/web/index.html)
set(OCTAVO_HAS_PAGE OFF)
find_program(OCTAVO_NODE NAMES node nodejs)
find_program(OCTAVO_NPM npm)
if(OCTAVO_VIEWER AND OCTAVO_NODE AND OCTAVO_NPM)
    execute_process(COMMAND ${OCTAVO_NODE} --version OUTPUT_VARIABLE version
                    OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(version MATCHES "^v([0-9]+)\\." AND CMAKE_MATCH_1 GREATER_EQUAL 18)
        set(OCTAVO_HAS_PAGE ON)
    else()
        message(STATUS "The viewer needs Node.js 18; this is ${version}: octavo view will have no page")
    endif()
else()
    message(STATUS "No Node.js and npm: octavo view will have no page")
endif()

if(OCTAVO_HAS_PAGE)
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/web/src/*)
    file(GLOB shared CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/octavo/attributes/*.h
         ${PROJECT_SOURCE_DIR}/src/octavo/trace/*.h
         ${PROJECT_SOURCE_DIR}/src/octavo/light/*.h
         ${PROJECT_SOURCE_DIR}/src/octavo/render/*.h)
    add_custom_command(OUTPUT ${OCTAVO_VIEWER_PAGE}
        COMMAND ${CMAKE_COMMAND} -D WEB=${PROJECT_SOURCE_DIR}/web -D PAGE=${OCTAVO_VIEWER_PAGE}
                -D NPM=${OCTAVO_NPM} -P ${PROJECT_SOURCE_DIR}/cmake/build_page.cmake
        DEPENDS ${sources} ${shared} ${PROJECT_SOURCE_DIR}/web/index.html
                ${PROJECT_SOURCE_DIR}/web/vite.config.ts ${PROJECT_SOURCE_DIR}/web/tsconfig.json
                ${PROJECT_SOURCE_DIR}/web/package-lock.json
                ${PROJECT_SOURCE_DIR}/cmake/build_page.cmake
        COMMENT "The viewer's page" VERBATIM)
    add_custom_target(viewer_page DEPENDS ${OCTAVO_VIEWER_PAGE})
endif()
