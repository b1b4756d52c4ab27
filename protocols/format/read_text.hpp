#pragma once

#include <filesystem>
#include <string>

namespace palpate::protocols {

/// The whole text of a file. @throws ProtocolError "file:1:1: cannot be read: why; check the path"
[[nodiscard]] std::string read_text(const std::filesystem::path& file);

}  // namespace palpate::protocols
