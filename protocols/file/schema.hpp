#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "engine/geometry/vec.hpp"
#include "engine/math/elementary.hpp"
#include "protocols/file/document.hpp"

/// What a file may say: one row a key, for protocols, procedures, scenes and calibrations alike.
/// Reading, checks of type and range, canonical texts and the reference for people are driven by
/// these rows, so that they cannot disagree.
namespace palpate::protocols {

/// Numbers that a key takes, in the file's unit; never one that is not finite.
struct Range {
    double min = -std::numeric_limits<double>::infinity();
    double max = std::numeric_limits<double>::infinity();
    bool above = false;  ///< `min` itself is refused
    bool below = false;  ///< `max` itself is refused

    /// Whether a key may have this value; NaN and infinities never.
    [[nodiscard]] bool has(double value) const noexcept {
        return std::isfinite(value) && (below ? value < max : value <= max) &&
               (above ? value > min : value >= min);
    }
};

/// Products of a few such numbers are finite.
inline constexpr double kLargest = 1e9;
inline constexpr Range kFromZero{.min = 0.0, .max = kLargest};
inline constexpr Range kPositive{.min = 0.0, .max = kLargest, .above = true};
inline constexpr Range kPlace{.min = -1e6, .max = 1e6};
/// Degrees of a radian, for keys that end in _deg.
inline constexpr double kDegrees = 180.0 / engine::kPi;

/// When a key has to be there.
enum class Need : std::uint8_t {
    required,
    optional,         ///< left out: as the struct begins
    factorial,        ///< required without [procedure]
    by_law,           ///< of a friction: required by some laws, refused with the others
    by_law_optional,  ///< of a friction: read by some laws, refused with the others
    two_curve,        ///< curvature: required by an object of two curves, refused with a free form
};

/// How a text or a list is restricted.
enum class Form : std::uint8_t {
    name,         ///< [a-z0-9_]+, at most 64; of numbers: a list
    free,         ///< one line, at most 200 bytes
    lines,        ///< lines of a screen, at most kMaxInstruction bytes and kMaxInstructionLines
    any,          ///< its reader restricts it
    one_or_more,  ///< a number or a list
    axis,         ///< a number, a list, { from, to, count } or { from, to, step }
    point,        ///< one, where others have a list of them
};

/// Longest instruction, bytes: it still fits onto a screen of 800 x 600 pixels in a legible size.
inline constexpr std::size_t kMaxInstruction = 600;
inline constexpr std::size_t kMaxInstructionLines = 8;
/// Of a seed: TOML integers have 63 bits and a sign.
inline constexpr double kMaxSeed = 9223372036854775807.0;

/// Points of two or of three coordinates.
struct PointList {
    int dimension = 2;
    std::vector<engine::Vec3> values{};  ///< z = 0 in the plane

    /// x and y of each.
    [[nodiscard]] std::vector<engine::Vec2> plane() const;
};
using PointGrid = std::vector<std::vector<engine::Vec3>>;
using NumberGrid = std::vector<std::vector<double>>;
using WordList = std::span<const std::string_view>;

/// An integer of any type, or none.
struct Whole {
    void* at = nullptr;
    std::optional<std::int64_t> (*get)(const void*) = nullptr;
    void (*set)(void*, std::int64_t) = nullptr;
};

/// One of several words, kept as its number.
struct OneOf {
    WordList words{};
    Whole number{};
};

/// Where the value of a key goes.
using Slot = std::variant<double*,
                          std::optional<double>*,
                          Whole,
                          OneOf,
                          bool*,
                          std::string*,
                          engine::Vec2*,
                          std::optional<engine::Vec2>*,
                          std::vector<double>*,
                          std::vector<std::string>*,
                          PointList*,
                          PointGrid*,
                          NumberGrid*>;

/// What is kept as a whole number.
template <class T>
concept WholeNumber = std::integral<T> || std::is_enum_v<T>;

/// A member that is a whole number of any width, as a slot reads and writes it: by its address and
/// two functions. @pre what is written fits; the key's range has been checked
template <WholeNumber T>
[[nodiscard]] Whole whole_of(T& value) {
    return {&value,
            [](const void* p) {
                return std::optional(static_cast<std::int64_t>(*static_cast<const T*>(p)));
            },
            [](void* p, std::int64_t v) {
                *static_cast<T*>(p) = static_cast<T>(v);
            }};
}
/// The same of a member that may be absent.
template <std::integral T>
[[nodiscard]] Whole whole_of(std::optional<T>& value) {
    return {&value,
            [](const void* p) {
                const auto& v = *static_cast<const std::optional<T>*>(p);
                return v ? std::optional<std::int64_t>(*v) : std::nullopt;
            },
            [](void* p, std::int64_t v) {
                *static_cast<std::optional<T>*>(p) = static_cast<T>(v);
            }};
}

template <class Enumeration>
struct HasNoWords;
/// The words of an enumeration as files have them, in the order of its values: specialised for
/// each.
template <class Enumeration>
inline constexpr HasNoWords<Enumeration> kWordsOf;

template <class Enumeration>
[[nodiscard]] constexpr WordList words_of(Enumeration /*any*/) {
    return kWordsOf<Enumeration>;
}
/// Its word in a file.
template <class Enumeration>
[[nodiscard]] constexpr std::string_view word_of(Enumeration value) {
    return kWordsOf<Enumeration>[static_cast<std::size_t>(value)];
}

/// The slot of a variable; an enumeration has its kWordsOf.
template <class T>
[[nodiscard]] Slot slot_of(T& value) {
    if constexpr (std::is_enum_v<T>) {
        return OneOf{words_of(T{}), whole_of(value)};
    } else if constexpr (!std::is_same_v<T, bool> && requires { whole_of(value); }) {
        return whole_of(value);
    } else {
        return &value;
    }
}

/// What stands behind the slots of a record; of nullptr as the struct begins.
template <class Record>
[[nodiscard]] Record& record_at(void* record) {
    static Record begun{};
    return record == nullptr ? begun : *static_cast<Record*>(record);
}

namespace detail {
/// Never defined: decltype finds the struct that a member belongs to.
template <class Record, class Member>
Record owner_of(Member Record::*);
}  // namespace detail
template <auto Member>
using OwnerOf = decltype(detail::owner_of(Member));

/// What lies in a record: step by step a member, or an item by its number.
template <auto Step, auto... Deeper, class Record>
[[nodiscard]] auto& part_of(Record& record) {
    if constexpr (sizeof...(Deeper) > 0) {
        return part_of<Deeper...>(part_of<Step>(record));
    } else if constexpr (std::is_member_pointer_v<decltype(Step)>) {
        return record.*Step;
    } else {
        return record[Step];
    }
}

/// The slot of a part of a record.
template <class Record, auto... Steps>
[[nodiscard]] Slot in(void* record) {
    return slot_of(part_of<Steps...>(record_at<Record>(record)));
}
/// The same where the record is the struct of the first member.
template <auto Member, auto... Deeper>
inline constexpr auto at = in<OwnerOf<Member>, Member, Deeper...>;

/// One key of a table.
struct Key {
    std::string_view name;          ///< carries the unit
    Slot (*slot)(void*) = nullptr;  ///< of a record; of nullptr: its default
    Need need = Need::optional;
    Range range{};        ///< of a number, or of every number of a list or point
    double per_si = 1.0;  ///< file value = SI value * per_si: 1000 for mm and ms, 0.001 for 1/ms
    Form form = Form::name;
    std::string_view meaning;
};
using Keys = std::span<const Key>;

/// The rows of the table of a protocol that fills this struct; [study] fills Protocol itself.
template <class Record>
[[nodiscard]] Keys keys_of();

/// "0 to 50", "above 0, at most 50", "0 or more", ...
[[nodiscard]] std::string range_of(const Range& range);
/// The same of any kind of key: "letters a-z, digits and _", ...
[[nodiscard]] std::string range_of(const Key& key);
/// Its meaning for terminals and editors, where Markdown's links lead nowhere.
[[nodiscard]] std::string meaning_of(const Key& key);

// ----------------------------------------------------------------------------------------- reading

/// Everything that is wrong with one file.
class Problems {
public:
    /// A problem at a place, a sentence with the value and the remedy; or all of another
    /// collection.
    void add(const Position& at, std::string what);
    void take(Problems&& others);
    [[nodiscard]] bool none() const noexcept { return found_.empty(); }
    /// @throws ProtocolError with all problems in file order, if there are any
    void throw_if_any(std::string_view file_name) const;

private:
    std::multimap<Position, std::string> found_;
};

/// Where every key and table stands, by a path such as "design.break_every" or "object.3.name".
class Places {
public:
    /// That `path` stands at `at`; of a path that stands twice the later place.
    void note(const std::string& path, const Position& at);
    /// Whether the file has this key or table.
    [[nodiscard]] bool has(const std::string& path) const;
    /// The place of `path`, else of the table around it, else the start of the file.
    [[nodiscard]] Position of(std::string path) const;

private:
    std::map<std::string, Position> places_;
};

/// The entry of this key; null if there is none.
[[nodiscard]] const Entry* find(const Table& table, std::string_view key);

/// The place of the value that a sentence such as "min is 3: ..." or "knots[4] = 1 is ..." begins
/// with, else `otherwise`.
[[nodiscard]] Position spoken_of(const Table& table,
                                 std::string_view sentence,
                                 const Position& otherwise);

/// One table of a file. Whatever is wrong becomes a problem at its place, and the value stays as it
/// was.
class TableReader {
public:
    /// @param path  of the table, as in Places
    /// @param name  what messages call it; empty: "[design]", "[[object]] 3" by the path
    TableReader(const Table& table,
                std::string path,
                const Position& at,
                Problems& problems,
                Places& places,
                std::string name = {});

    /// Reads these keys into the record that their slots know. @param complete required ones must
    /// be there
    void read(Keys keys, void* record, bool complete = true);
    template <class Record>
    void fill(Record& record, bool complete = true) {
        read(keys_of<Record>(), &record, complete);
    }
    /// The same of the last keys: every other one that was neither read nor known is a problem.
    void read_last(Keys keys, void* record) {
        read(keys, record);
        refuse_unknown();
    }
    /// Keys that others read.
    void know(WordList keys);
    /// Every key that was neither read nor known is a problem.
    void refuse_unknown();

    /// The key format has to be there, with this number.
    void check_format(std::int64_t wanted);

    /// The table has the key, read or not.
    [[nodiscard]] bool has(std::string_view key) const { return find(*table_, key) != nullptr; }
    /// The table as it was parsed.
    [[nodiscard]] const Table& table() const noexcept { return *table_; }
    /// Its path in the file, as Places has it: "design", "object.3"; and where it begins.
    [[nodiscard]] const std::string& path() const noexcept { return path_; }
    [[nodiscard]] const Position& at() const noexcept { return at_; }
    /// What messages call it.
    [[nodiscard]] const std::string& name() const noexcept { return name_; }
    /// A table in this one, if it is there.
    [[nodiscard]] std::optional<TableReader> table(std::string_view key);
    /// The tables [[key]] in this one.
    [[nodiscard]] std::vector<TableReader> tables(std::string_view key);
    /// A table of the same file. @param path, name  as in the constructor
    [[nodiscard]] TableReader of(const Table& table,
                                 std::string path,
                                 const Position& at,
                                 std::string name = {}) const {
        return {table, std::move(path), at, *problems_, *places_, std::move(name)};
    }

    /// That it stands for this path as well.
    void note(const std::string& path) const { places_->note(path, at_); }

    /// A problem of this key, or of the table if the key is not there.
    void refuse(std::string_view key, std::string what);
    /// Runs `make`; a std::invalid_argument becomes a problem of the key that it begins with, else
    /// of this table. Only if all keys were good.
    template <class Make>
    void attempt(Make&& make) {
        if (broken_) {
            return;
        }
        try {
            make();
        } catch (const std::invalid_argument& e) {
            add(spoken_of(*table_, e.what(), at_), name_ + ": " + e.what());
        }
    }
    void add(const Position& at, std::string what);
    void fail() noexcept { broken_ = true; }  ///< its problem was noted elsewhere
    [[nodiscard]] bool broken() const noexcept { return broken_; }  ///< a problem was found so far

private:
    const Table* table_;
    std::string path_;
    Position at_;
    Problems* problems_;
    Places* places_;
    std::string name_;
    std::vector<std::string_view> known_{};
    bool broken_ = false;
};

/// Reads the value of one key into its slot; what is wrong is said to the table.
void read_value(const Key& key, const Value& value, const Slot& slot, TableReader& table);

// ----------------------------------------------------------------------------------------- writing

/// The shortest number y, in the file's unit, that a reader turns into `si` by y / per_si. A few
/// doubles are no such quotient; then y of the nearest one that is. Written, read and written again
/// it is the same text.
[[nodiscard]] std::string toml_text(double si, double per_si = 1.0);
/// In quotes, with escapes.
[[nodiscard]] std::string toml_text(const std::string& text);
/// "key = value" lines in the order of the rows; a text that is empty is none.
[[nodiscard]] std::string toml_lines(Keys keys, const void* record);

// --------------------------------------------------------------------------------------- reference

/// A table as people read of it.
struct TableText {
    std::string heading;   ///< "[design]"
    std::string remark{};  ///< behind it
    Keys keys{};
};

/// One line a key, tables as headings.
[[nodiscard]] std::string reference_text(std::span<const TableText> tables);
/// The same as Markdown: a table of key, unit, range, default and meaning under every heading.
[[nodiscard]] std::string reference_markdown(std::span<const TableText> tables);

}  // namespace palpate::protocols
