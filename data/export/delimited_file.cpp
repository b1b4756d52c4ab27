#include "data/export/delimited_file.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <zlib.h>

#include "data/csv/csv_text.hpp"
#include "data/export/number_text.hpp"

namespace palpate::data {
namespace {

constexpr std::size_t kPending = std::size_t{1} << 16U;

}  // namespace

DelimitedFile::DelimitedFile(std::filesystem::path path, TableStyle style)
    : path_(std::move(path)), style_(style) {
    // "T": as it is.
    file_ = gzopen(path_.c_str(), path_.extension() == ".gz" ? "wbe6" : "wbeT");
    if (file_ == nullptr) {
        fail();
    }
}

DelimitedFile::~DelimitedFile() {
    if (file_ != nullptr) {
        gzclose(static_cast<gzFile>(file_));
    }
}

void DelimitedFile::fail() const {
    throw std::runtime_error(fmt::format(
        "cannot write {}: is its folder writable and the disk not full?", path_.string()));
}

void DelimitedFile::raw(std::string_view value) {
    if (!first_) {
        pending_ += style_ == TableStyle::csv ? ',' : '\t';
    }
    first_ = false;
    pending_ += value;
}

void DelimitedFile::text(std::string_view value) {
    raw(style_ == TableStyle::tsv ? tsv_field(value) : csv_field(value));
}

void DelimitedFile::integer(std::int64_t value) {
    raw(fmt::format("{}", value));
}
void DelimitedFile::real(double value) {
    std::isnan(value) ? none() : raw(number_text(value));
}
void DelimitedFile::none() {
    raw(style_ == TableStyle::tsv ? "n/a" : "");
}

void DelimitedFile::value(const TickValue& value) {
    if (const auto* whole = std::get_if<std::int64_t>(&value)) {
        integer(*whole);
    } else if (const auto* number = std::get_if<double>(&value)) {
        real(*number);
    } else {
        text(std::get<std::string_view>(value));
    }
}

void DelimitedFile::value(const Statement& row, int column) {
    switch (row.type(column)) {
        case 1:
            return integer(row.integer(column));
        case 2:
            return real(row.real(column));
        case 5:
            return none();
        default:
            return text(row.text(column));
    }
}

void DelimitedFile::end_row() {
    pending_ += '\n';
    first_ = true;
    if (pending_.size() >= kPending) {
        flush();
    }
}

void DelimitedFile::flush() {
    const auto size = static_cast<unsigned>(pending_.size());
    if (size > 0 && gzwrite(static_cast<gzFile>(file_), pending_.data(), size) <= 0) {
        fail();
    }
    pending_.clear();
}

void DelimitedFile::close() {
    flush();
    if (gzclose(static_cast<gzFile>(std::exchange(file_, nullptr))) != Z_OK) {
        fail();
    }
}

void write_rows(Statement row, DelimitedFile& file) {
    while (row.step()) {
        for (int column = 0; column < row.columns(); ++column) {
            file.value(row, column);
        }
        file.end_row();
    }
    file.close();
}

}  // namespace palpate::data
