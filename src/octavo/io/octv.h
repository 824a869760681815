// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "octavo/core/progress.h"
#include "octavo/io/model.h"

namespace octavo {

struct OctvWriteOptions {
    bool compress = false;  // DAG and attributes as zstd: a smaller file, which cannot be mapped
    ProgressFunction progress = {};  // phase "write", in bytes of the DAG
};

/// Writes an .octv file; docs/file-format.md has the bytes. The file appears whole or not at all,
/// and replaces what was there. Equal models give equal bytes.
///
/// @throws Error  io, the old file is then untouched; cancelled; bad_argument where the metadata
///                does not describe the DAG
/// Cost           the time to write; a few MiB of memory beside the model
void write_octv(const std::filesystem::path& path, const Model& model,
                const OctvWriteOptions& options = {});

/// Where the time of a read went, in seconds.
struct OctvReadTimes {
    double read = 0.0;        // from the file into memory; of a mapped file, next to nothing
    double checksum = 0.0;    // of all sections
    double decompress = 0.0;  // where the DAG is compressed
    double validate = 0.0;    // the nodes and counts of the DAG
};

struct OctvReadOptions {
    /// Maps the file and takes it at its word: no checksum and no check of the DAG, so that opening
    /// takes no time whatever its size. Only for files that you wrote and that nobody changes while
    /// they are in use: a damaged one can crash the tracing, and one that is cut off meanwhile ends
    /// the process with SIGBUS.
    bool trusted = false;

    /// Checks as usual, but maps the file instead of copying it: half the memory where many
    /// processes read it. Only where nobody changes it while it is in use, as above.
    bool map = false;

    /// Where the compressed sections together claim more than this, or than half of the machine's
    /// memory, the file is refused before any is taken.
    std::uint64_t max_dag_bytes = std::uint64_t{16} << 30;

    bool attributes = true;  // read them, where the file has any

    OctvReadTimes* times = nullptr;  // filled in where given
};

/// Reads an .octv file into memory of its own. Any bytes give a model that is safe to trace, and
/// stays so whatever happens to the file; or an Error with the offset and the reason; never a
/// crash, nor more memory than the DAG's size and, while it is checked, 8 bytes for each node.
///
/// @throws Error  io; bad_input; unsupported where the file needs a newer program; limit
/// Cost           docs/results.md: one pass that copies, one checksum, one visit of every node;
///                nothing where trusted
[[nodiscard]] Model read_octv(const std::filesystem::path& path,
                              const OctvReadOptions& options = {});

/// What can be known of a file without its DAG.
struct OctvSummary {
    Metadata metadata;
    std::uint64_t file_bytes = 0;
    bool compressed = false;
    /// Bytes that each channel of the attributes takes, unpacked; 0 where it is not there.
    std::array<std::uint64_t, Attributes::kChannels> attribute_bytes{};
    std::uint64_t light_bytes = 0;  // of the cells' light, unpacked
};

/// Reads and checks header and metadata only: takes no time, whatever the size of the DAG.
/// @throws Error  as read_octv
[[nodiscard]] OctvSummary read_octv_summary(const std::filesystem::path& path);

}  // namespace octavo
