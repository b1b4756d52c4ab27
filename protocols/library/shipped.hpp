#pragma once

#include <span>
#include <string>
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

/// The shipped protocol of this name. @throws std::invalid_argument naming those that there are
[[nodiscard]] const ShippedProtocol& shipped_protocol(std::string_view name);

/// The calibration file with the machines that ship, protocols/library/pantographs.toml.
[[nodiscard]] std::string_view shipped_pantographs() noexcept;

// A protocol file to begin with: a shipped one under another name.

/// A study's id from a file's name without its ending: letters small, whatever no id may hold as
/// one _, at most 64 of them; "study" if nothing is left.
[[nodiscard]] std::string id_of(std::string_view name);

/// The text of `from` with all its comments, `id` and `title` replaced, and a first line that says
/// what it was made from. @param id as id_of gives it
[[nodiscard]] std::string new_protocol(const ShippedProtocol& from, const std::string& id);

}  // namespace palpate::protocols
