// SPDX-License-Identifier: MIT
#include "viewer_page.h"

#include <array>
#include <cstdint>

#include "octavo/core/error.h"

#if OCTAVO_HAS_PAGE
// The assembler puts the built page between these; see apps/octavo/CMakeLists.txt.
extern "C" const char octavo_page_begin[];
extern "C" const char octavo_page_end[];
#endif

namespace octavo::cli {
namespace {

constexpr std::string_view kPlace = "<!--octavo-config-->";

/// JSON inside a script element: "</script" and "<!--" must not stand in it.
std::string script_text(const nlohmann::json& value) {
    std::string text = value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;)
        text.replace(at, 1, "\\u003c");
    return text;
}

struct Parts {
    std::string_view before;
    std::string_view after;
};

Parts page_parts() {
    const std::string_view page = viewer_page();
    const std::size_t at = page.find(kPlace);
    return {page.substr(0, at), page.substr(at + kPlace.size())};
}

std::string config_element(const nlohmann::json& config) {
    return R"(<script type="application/json" id="octavo-config">)" + script_text(config) +
           "</script>";
}

std::string base64(std::span<const std::byte> bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = group << 8 | (k < count ? static_cast<std::uint32_t>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += k <= count ? kDigits[group >> (18 - 6 * k) & 63u] : '=';
    }
    return text;
}

}  // namespace

std::string_view viewer_page() {
    std::string_view page;
#if OCTAVO_HAS_PAGE
    page = {octavo_page_begin, static_cast<std::size_t>(octavo_page_end - octavo_page_begin)};
#endif
    if (page.find(kPlace) == std::string_view::npos)
        throw Error(
            Errc::unsupported,
            "this build has no viewer: it was made without Node.js 18 and npm, or npm could "
            "not fetch the packages of web/; install them and build again");
    return page;
}

std::string configured_page(const nlohmann::json& config) {
    const Parts parts = page_parts();
    return std::string(parts.before) + config_element(config) + std::string(parts.after);
}

void write_single_page(const std::string& name, std::span<const std::byte> file,
                       const std::function<void(std::string_view)>& write) {
    constexpr std::size_t kPieceBytes = std::size_t{3} << 20;
    const Parts parts = page_parts();
    write(parts.before);
    write(config_element({{"name", name}, {"inline", true}}));
    write(R"(<script type="application/octet-stream" id="octavo-scene">)");
    for (std::size_t at = 0; at < file.size(); at += kPieceBytes)
        write(base64(file.subspan(at, std::min(kPieceBytes, file.size() - at))));
    write("</script>");
    write(parts.after);
}

}  // namespace octavo::cli
