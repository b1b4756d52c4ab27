#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "engine/base/files.hpp"

namespace palpate {

/// write_whole() bit by bit, for what is longer than the memory: the file is there once it is
/// finished. Standard output gets each bit at once.
class WholeText {
public:
    /// @param head  how the text begins: what is there is written over only if it is of this kind;
    /// it is not written
    /// @throws as write_whole()
    WholeText(const std::filesystem::path& file,
              std::string_view head,
              Rights rights = Rights::usual);
    WholeText(const WholeText&) = delete;
    WholeText& operator=(const WholeText&) = delete;
    ~WholeText();  ///< what is not finished is removed

    void add(std::string_view text);  ///< @throws as write_whole()
    void finish();                    ///< @throws as write_whole()

private:
    std::filesystem::path file_;
    std::string part_;  ///< the file beside it; empty: none
    int fd_ = -1;
};

}  // namespace palpate
