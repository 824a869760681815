// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace octavo::cli {

/// KEY=VALUE:KEY=VALUE..., as lights and skies have them behind their kind. Each part is taken by
/// who knows its key; what is left in the end is a mistake.
class KeyValues {
public:
    /// @throws Error  bad_argument where a part is not KEY=VALUE
    explicit KeyValues(std::string_view text);

    /// Takes the first part with this key away, if it is there.
    [[nodiscard]] std::optional<std::string> take(std::string_view key);
    /// @param what    the thing described, as in "a sun"
    /// @throws Error  bad_argument naming a part that nobody took
    void check_all_taken(const std::string& what) const;

private:
    std::vector<std::pair<std::string, std::string>> parts_;
};

}  // namespace octavo::cli
