#pragma once

#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/text.hpp"
#include "protocols/file/document.hpp"

/// Private to protocols/format: turns a document's tables into structs and notes every problem.
namespace palpate::protocols {

/// Everything that is wrong with one file.
class Problems {
public:
    void add(const Position& at, std::string what) { found_.insert({at, std::move(what)}); }
    void take(Problems&& others) { found_.merge(others.found_); }
    [[nodiscard]] bool none() const noexcept { return found_.empty(); }
    /// @throws ProtocolError with all problems in file order, if there are any
    void throw_if_any(std::string_view file_name) const;

private:
    std::multimap<Position, std::string> found_;
};

/// Where every key and table stands, by a path such as "design.break_every" or "object.3.name".
class Places {
public:
    void note(const std::string& path, const Position& at) { places_.insert_or_assign(path, at); }
    [[nodiscard]] bool has(const std::string& path) const;
    /// The place of `path`, else of the table around it, else the start of the file.
    [[nodiscard]] Position of(std::string path) const;

private:
    std::map<std::string, Position> places_;
};

/// The place of the value that a sentence such as "lowest is 3: ..." begins with, else `otherwise`.
[[nodiscard]] Position spoken_of(const Table& table,
                                 std::string_view sentence,
                                 const Position& otherwise);

/// How a table is to be read that says more than the rows of its keys.
struct Beyond {
    std::span<const std::string_view> known_elsewhere{};  ///< keys that others read
    bool complete = true;                                 ///< required keys have to be there
};

/// Reads tables by the rows of keys_of<Record>().
class Reader {
public:
    Reader(Problems& problems, Places& places) : problems_(problems), places_(places) {}

    /// Fills `record` from `table`. Unknown, missing and bad keys become problems.
    /// @param path  of the table, as in Places
    template <class Record>
    void read(const Table& table,
              const std::string& path,
              const Position& at,
              Record& record,
              const Beyond& beyond = {});

private:
    Problems& problems_;
    Places& places_;
};

}  // namespace palpate::protocols
