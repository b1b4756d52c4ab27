#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

namespace palpate::data {

/// The text of a file that can be read more than once: what is no file on a disk, a pipe or
/// standard input, is copied to one without a name.
class RereadableText {
public:
    /// @throws CsvError (data/csv/number_table.hpp) if it cannot be read or copied
    explicit RereadableText(const std::filesystem::path& file);
    RereadableText(const RereadableText&) = delete;
    RereadableText& operator=(const RereadableText&) = delete;
    ~RereadableText();

    [[nodiscard]] const std::filesystem::path& place() const noexcept { return place_; }
    [[nodiscard]] const std::string& name() const noexcept { return name_; }  ///< as it was given

private:
    void close();

    std::string name_;
    std::filesystem::path place_;
    std::FILE* copy_ = nullptr;
};

}  // namespace palpate::data
