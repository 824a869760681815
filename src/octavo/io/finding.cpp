// SPDX-License-Identifier: MIT
#include "octavo/io/finding.h"

namespace octavo {

Finding finding_of(const Error& error) {
    if (const auto* known = dynamic_cast<const FormatError*>(&error)) return known->finding();
    std::string message = error.what();
    const std::string file = error.file().string();
    if (!file.empty() && message.starts_with(file)) {
        const std::size_t colon = message.find(": ", file.size());
        if (colon != std::string::npos) message.erase(0, colon + 2);
    }
    const char* code = error.code() == Errc::unsupported ? "unsupported"
                       : error.code() == Errc::limit     ? "limit"
                                                         : "content";
    return {code, error.offset(), message};
}

}  // namespace octavo
