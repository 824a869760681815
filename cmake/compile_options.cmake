# Options that every target of the project is compiled with.
add_library(octavo_compile_options INTERFACE)

target_compile_options(octavo_compile_options INTERFACE
    -Wall -Wextra -Wshadow -Wpedantic -Wconversion
    # clang counts it to -Wconversion, g++ does not: an int as an index is no mistake by itself.
    $<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion>
    # The shared ray text must give the same floats on every backend: no fused multiply-add.
    -ffp-contract=off)
if(OCTAVO_WERROR)
    target_compile_options(octavo_compile_options INTERFACE -Werror)
endif()

# The oldest machine we support has SSE4.2 and POPCNT; wider SIMD is chosen at run time. In every
# build: Highway has no vectors of four lanes below it, which the overlap kernel needs.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT CMAKE_CXX_FLAGS MATCHES "-march=")
    target_compile_options(octavo_compile_options INTERFACE -march=x86-64-v2)
endif()

# Against what a fault in memory could be used for.
option(OCTAVO_HARDEN "Compile releases with stack protector and checked C functions" ON)
if(CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT OCTAVO_SANITIZE AND NOT APPLE)
    target_link_options(octavo_compile_options INTERFACE -Wl,-z,relro,-z,now,-z,noexecstack)
    if(OCTAVO_HARDEN)
        target_compile_options(octavo_compile_options INTERFACE
            -D_FORTIFY_SOURCE=2 -fstack-protector-strong -fcf-protection)
    endif()
endif()

if(OCTAVO_SANITIZE)
    target_compile_options(octavo_compile_options INTERFACE
        -fsanitize=${OCTAVO_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(octavo_compile_options INTERFACE -fsanitize=${OCTAVO_SANITIZE})
endif()
