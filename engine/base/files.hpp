#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

#include <sys/types.h>

#include "engine/base/descriptor.hpp"
#include "engine/base/text.hpp"

namespace palpate {

/// What somebody should know though nothing failed, to standard error: "palpate: ", the sentence on
/// one line, the end of the line. That nobody reads it is no error.
inline void remark(std::string_view sentence) {
    const std::string line = "palpate: " + plain(sentence) + '\n';
    static_cast<void>(std::fwrite(line.data(), 1, line.size(), stderr));
}

/// Waits until the bytes of a file, or the names in a folder, are on the disk: a power cut from
/// here on does not lose them. A file's name is its folder's.
/// @return false: the disk refused, errno says why
[[nodiscard]] bool sync_to_disk(const std::filesystem::path& what);

/// The folder that holds a file's name.
[[nodiscard]] std::filesystem::path folder_of(const std::filesystem::path& file);

/// The first line of a file; empty if it cannot be read.
[[nodiscard]] std::string first_line(const std::filesystem::path& file);

/// All of a file; empty if it cannot be read.
[[nodiscard]] std::string file_text(const std::filesystem::path& file);

/// Who may read what is written.
enum class Rights : std::uint8_t {
    usual,  ///< whom the umask lets
    own,    ///< its owner alone: it can tell who somebody is
};

/// What is made under another name beside its place has this and six letters behind the place's
/// name.
inline constexpr std::string_view kPartName = ".palpate-part-";

/// `wanted` without what the umask takes away.
[[nodiscard]] mode_t usual_rights(mode_t wanted);

/// Holds what is half made, for as long as this lives: what nobody holds was left behind.
class PartLock {
public:
    /// Locks the file or folder (flock). Where that cannot be had nothing is removed either;
    /// nothing is thrown.
    explicit PartLock(const std::filesystem::path& part);

private:
    Descriptor part_;
};

/// Removes from a folder what a palpate of this user that was killed left half made there, and says
/// so.
void remove_leftovers(const std::filesystem::path& folder);

/// Before long work: whether write_whole() could write it now. Removes leftovers. @throws as
/// write_whole()
/// @param text the text that will be written, or how it will begin; empty: nothing is there yet
void require_writable(const std::filesystem::path& file, std::string_view text);

/// Writes the text so that the file is either whole or as it was: to a new file beside it, synced,
/// then renamed: no link is followed. An empty path means standard output.
///
/// What is there is written over only if it is empty or of the text's own kind, as the same command
/// wrote it before: it begins with the same tag (<svg, <!DOCTYPE), the same head of a CSV, or the
/// same first three lines of a TOML file. Anything else stays: a database, somebody's table, a
/// protocol. Pipes and terminals have no kind.
/// @throws std::invalid_argument if a file of another kind is there, std::runtime_error if it
///         cannot be written; both with file, why and remedy
void write_whole(const std::filesystem::path& file,
                 std::string_view text,
                 Rights rights = Rights::usual);

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

/// Writes a file that is not there yet, and syncs it: nobody's file is ever written over, whoever
/// comes first.
/// @throws std::invalid_argument if it is there or cannot be made, std::runtime_error if it did not
///         become whole: it is gone then
void write_new(const std::filesystem::path& file,
               std::string_view text,
               Rights rights = Rights::usual);

/// Makes a folder and those around it, as far as they are not there.
/// @throws std::invalid_argument if that cannot be done
void make_folder(const std::filesystem::path& folder);

}  // namespace palpate
