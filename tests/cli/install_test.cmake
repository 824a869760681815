# Installs the build to an empty folder, takes the program and the CMake lines out of the README, and
# builds and runs them there as a stranger would, who compiles with all warnings.
function(run)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT result EQUAL 0)
        message(FATAL_ERROR "${ARGN}\nfailed with ${result}:\n${output}")
    endif()
endfunction()

# readme_block(LANGUAGE NAME): the first block of that language in the README
function(readme_block language name)
    file(READ ${SOURCE_FOLDER}/README.md readme)
    string(FIND "${readme}" "```${language}\n" begin)
    if(begin EQUAL -1)
        message(FATAL_ERROR "README.md has no ${language} block")
    endif()
    string(LENGTH "```${language}\n" skip)
    math(EXPR begin "${begin} + ${skip}")
    string(SUBSTRING "${readme}" ${begin} -1 rest)
    string(FIND "${rest}" "```" end)
    string(SUBSTRING "${rest}" 0 ${end} block)
    set(${name} "${block}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK_FOLDER})
run(${CMAKE_COMMAND} --install ${BUILD_FOLDER} --prefix ${WORK_FOLDER}/prefix)

readme_block(cpp program)
readme_block(cmake lines)
file(WRITE ${WORK_FOLDER}/source/main.cpp "${program}")
file(WRITE ${WORK_FOLDER}/source/CMakeLists.txt
"cmake_minimum_required(VERSION 3.25)
project(consumer LANGUAGES CXX)
add_executable(your_program main.cpp)
${lines}")
set(flags "")
if(SANITIZE)
    set(flags -DCMAKE_EXE_LINKER_FLAGS=-fsanitize=${SANITIZE})
endif()
run(${CMAKE_COMMAND} -S ${WORK_FOLDER}/source -B ${WORK_FOLDER}/build -G ${GENERATOR}
    -DCMAKE_CXX_COMPILER=${CXX_COMPILER} "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror" -DCMAKE_PREFIX_PATH=${WORK_FOLDER}/prefix ${flags})
run(${CMAKE_COMMAND} --build ${WORK_FOLDER}/build)
run(${CMAKE_COMMAND} -E chdir ${WORK_FOLDER} ${WORK_FOLDER}/build/your_program)
run(${WORK_FOLDER}/prefix/bin/octavo info ${WORK_FOLDER}/courtyard.octv)
