// SPDX-License-Identifier: MIT
#include "octavo/io/compression.h"

#include <zstd.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "octavo/core/error.h"

namespace octavo {
namespace {

// On the courtyard's 37.7 MB at 8192^3, level 1, 3 and 6 leave 21.7, 19.8 and 18.8 MB and take 0.3,
// 0.5 and 1.1 s (2026-11, one core); a file is compressed once and kept.
constexpr int kLevel = 6;

std::size_t checked(std::size_t result) {
    if (ZSTD_isError(result))
        throw Error(Errc::io, std::string("compression failed: ") + ZSTD_getErrorName(result));
    return result;
}

}  // namespace

void zstd_compress(std::span<const std::byte> raw,
                   const std::function<void(std::span<const std::byte>)>& sink,
                   const std::function<void(std::uint64_t)>& consumed) {
    const std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> context(ZSTD_createCCtx(),
                                                                          ZSTD_freeCCtx);
    if (!context) throw Error(Errc::io, "compression failed: out of memory");
    checked(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kLevel));
    checked(ZSTD_CCtx_setPledgedSrcSize(context.get(), raw.size()));

    std::vector<std::byte> piece(ZSTD_CStreamOutSize());
    constexpr std::size_t kFeedBytes = std::size_t{4} << 20;
    for (std::size_t fed = 0; fed < raw.size();) {
        const std::size_t feed = std::min(kFeedBytes, raw.size() - fed);
        const bool last = fed + feed == raw.size();
        ZSTD_inBuffer in = {raw.data() + fed, feed, 0};
        for (bool more = true; more;) {
            ZSTD_outBuffer out = {piece.data(), piece.size(), 0};
            const std::size_t left = checked(ZSTD_compressStream2(
                context.get(), &out, &in, last ? ZSTD_e_end : ZSTD_e_continue));
            if (out.pos > 0) sink(std::span(piece).first(out.pos));
            more = last ? left != 0 : in.pos < in.size;
        }
        fed += feed;
        consumed(fed);
    }
}

std::optional<std::uint64_t> zstd_content_size(std::span<const std::byte> frame) {
    const unsigned long long size = ZSTD_getFrameContentSize(frame.data(), frame.size());
    if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN) return std::nullopt;
    // More frames after the first would be content that the first one's header does not count.
    if (ZSTD_findFrameCompressedSize(frame.data(), frame.size()) != frame.size())
        return std::nullopt;
    return size;
}

std::optional<std::string> zstd_decompress(std::span<const std::byte> frame,
                                           std::span<std::byte> raw) {
    const std::size_t size = ZSTD_decompress(raw.data(), raw.size(), frame.data(), frame.size());
    if (ZSTD_isError(size)) return ZSTD_getErrorName(size);
    if (size != raw.size()) return "the content is shorter than stated";
    return std::nullopt;
}

}  // namespace octavo
