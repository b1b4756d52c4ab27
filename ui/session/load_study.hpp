#pragma once

#include <string>

#include "protocols/protocol/protocol.hpp"

namespace palpate::ui {

/// A protocol with its identity.
struct Study {
    protocols::Protocol protocol;
    std::string hash;  ///< SHA-256 of the canonical text
};

/// Reads a protocol file, or, if there is no such file, the shipped protocol of that name.
/// @throws protocols::ProtocolError, also where no order keeps its limits
[[nodiscard]] Study load_study(const std::string& file_or_name);

}  // namespace palpate::ui
