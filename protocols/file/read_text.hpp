#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace palpate::protocols {

/// The longest text that is read, bytes: some hours of a trajectory at 1 kHz.
inline constexpr std::size_t kMostText = std::size_t{1} << 30U;

/// The whole text of a file, a pipe or a terminal. No name makes it wait for ever or fill the memory: a pipe
/// has to give something every 10 s.
/// @param most  bytes; a longer text is refused
/// @throws ProtocolError "file:1:1: cannot be read: why; check the path"
[[nodiscard]] std::string read_text(const std::filesystem::path& file,
                                    std::size_t most = kMostText);

}  // namespace palpate::protocols
