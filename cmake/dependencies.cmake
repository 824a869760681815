# What Octavo stands on, each with the reason it is here. All are Debian 12 packages.
find_package(PkgConfig REQUIRED)

find_package(TBB REQUIRED)       # threads: parallel loops and the ordered build pipeline
if(OCTAVO_SANITIZE MATCHES "thread" AND NOT TBB_DIR MATCHES "tsan-tbb")
    message(WARNING "This oneTBB was not compiled for the thread sanitizer, which will report races "
                    "that are none: run scripts/tsan-tbb, then configure anew.")
endif()
find_package(glm REQUIRED)       # vectors with GLSL's names, which the shared ray text needs
find_package(nlohmann_json REQUIRED)  # JSON: file metadata, --json output
find_package(hwy REQUIRED)       # SIMD with run-time dispatch, for the voxel overlap kernel
find_package(ZLIB REQUIRED)      # gzipped meshes
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)  # checksums of file sections
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)      # optional compressed sections
pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET liblz4)        # what a build spills to its scratch folder

find_package(assimp REQUIRED)    # the many mesh formats that we do not read ourselves
find_package(PNG REQUIRED)       # pictures, and the textures of scenes
pkg_check_modules(TURBOJPEG REQUIRED IMPORTED_TARGET libturbojpeg)  # textures of scenes, pictures that `octavo view` sends
find_package(OpenEXR REQUIRED)   # pictures in linear floats

# Optional: builds by many machines together (packages libopenmpi-dev, openmpi-bin).
set(MPI_CXX_SKIP_MPICXX ON)
find_package(MPI QUIET COMPONENTS CXX)

if(OCTAVO_BUILD_APPS)
    find_package(CLI11 REQUIRED)  # command-line arguments
    find_package(fmt REQUIRED)    # tables: g++ 12 has no std::format
    # Optional: the server of `octavo view`.
    pkg_check_modules(HTTPLIB IMPORTED_TARGET cpp-httplib)
endif()
if(OCTAVO_BUILD_TESTS)
    find_package(GTest REQUIRED)
endif()
