#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "protocols/file/document.hpp"

namespace palpate::protocols {

/// read_text() piece by piece: no more of it is held than one.
class TextPieces {
public:
    /// @throws as read_text(), as next() does
    explicit TextPieces(const std::filesystem::path& file, std::size_t max = kMaxText);
    TextPieces(const TextPieces&) = delete;
    TextPieces& operator=(const TextPieces&) = delete;
    ~TextPieces();

    /// The next piece, appended to `text`. @return false at the end
    [[nodiscard]] bool next(std::string& text);

private:
    std::string file_;
    std::size_t max_;
    std::size_t read_ = 0;  ///< bytes
    int fd_ = -1;
};

}  // namespace palpate::protocols
