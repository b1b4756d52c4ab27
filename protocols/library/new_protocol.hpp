#pragma once

#include <string>
#include <string_view>

#include "protocols/library/shipped.hpp"

/// A protocol file to begin with: a shipped one under another name.
namespace palpate::protocols {

/// A study's id from a file's name without its ending: letters small, whatever no id may hold as
/// one _, at most 64 of them; "study" if nothing is left.
[[nodiscard]] std::string id_of(std::string_view name);

/// The shipped protocol of this name. @throws std::invalid_argument naming those that there are
[[nodiscard]] const ShippedProtocol& shipped_protocol(std::string_view name);

/// The text of `from` with all its comments, `id` and `title` replaced, and a first line that says
/// what it was made from. @param id as id_of gives it
[[nodiscard]] std::string new_protocol(const ShippedProtocol& from, const std::string& id);

}  // namespace palpate::protocols
