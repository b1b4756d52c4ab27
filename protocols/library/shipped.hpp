#pragma once

#include <span>
#include <string_view>

namespace palpate::protocols {

/// A protocol file that is part of the program. The source file is written by the build from the
/// *.toml files of this folder.
struct ShippedProtocol {
    std::string_view name;  ///< the file's name without .toml
    std::string_view text;
};

/// All that ship, by name.
[[nodiscard]] std::span<const ShippedProtocol> shipped_protocols() noexcept;

/// The calibration file with the machines that ship, protocols/library/pantographs.toml.
[[nodiscard]] std::string_view shipped_pantographs() noexcept;

}  // namespace palpate::protocols
