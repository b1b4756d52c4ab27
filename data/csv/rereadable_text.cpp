#include "data/csv/rereadable_text.hpp"

#include <cerrno>
#include <system_error>

#include <fmt/format.h>

#include "protocols/file/text_pieces.hpp"
#include "data/csv/number_table.hpp"

namespace palpate::data {

RereadableText::RereadableText(const std::filesystem::path& file)
    : name_(file.string()), place_(file) {
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error)) {
        return;
    }
    try {
        protocols::TextPieces pieces(file);
        copy_ = std::tmpfile();
        std::string piece;
        while (copy_ != nullptr && pieces.next(piece)) {
            if (std::fwrite(piece.data(), 1, piece.size(), copy_) != piece.size()) {
                break;
            }
            piece.clear();
        }
    } catch (const protocols::ProtocolError& e) {  // it names the file and why
        close();
        throw CsvError(e.what());
    }
    if (copy_ == nullptr || std::fflush(copy_) != 0 || std::ferror(copy_) != 0) {
        const std::string why = std::generic_category().message(errno);
        close();
        throw CsvError(fmt::format(
            "{}:1: cannot be copied to a file without a name: {}; check the space in /tmp, or give "
            "a file on a disk",
            name_, why));
    }
    place_ = fmt::format("/proc/self/fd/{}", ::fileno(copy_));
}

void RereadableText::close() {
    if (copy_ != nullptr) {
        std::fclose(copy_);
    }
    copy_ = nullptr;
}

RereadableText::~RereadableText() {
    close();
}

}  // namespace palpate::data
