#pragma once

#include "tests/support/std.hpp"

namespace palpate::bench {

/// A word of the command line that means nothing: a sentence for its author, exit code 2.
class WrongWord : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// nasty [--peers] [--csv FILE]
int nasty_command(const std::vector<std::string>& words);
/// contact [--peers] [--objects LETTERS] [--seconds S] [--against BINARY] [--csv FILE] [--svg
/// FILE], or --from FILE --svg FILE
int contact_command(const std::vector<std::string>& words);
/// scaling [--csv FILE]
int scaling_command(const std::vector<std::string>& words);
/// passivity [--csv FILE]
int passivity_command(const std::vector<std::string>& words);
/// servo [--rounds N] [--seconds S] [--spin SHARE] [--csv FILE]
int servo_command(const std::vector<std::string>& words);
/// friction [--csv FILE] [--svg FILE]
int friction_command(const std::vector<std::string>& words);
/// guard [--kills N] [--csv FILE]
int guard_command(const std::vector<std::string>& words);
/// data [--peers] [--trials N] [--seconds S] [--cores 1|2] [--csv FILE]
int data_command(const std::vector<std::string>& words);
/// procedure [--csv FILE]
int procedure_command(const std::vector<std::string>& words);

/// The words after a command. Every word must be taken, or `finish` refuses.
class Words {
public:
    explicit Words(std::vector<std::string> words) : words_(std::move(words)) {}

    /// Takes `name` if it is there.
    [[nodiscard]] bool flag(const std::string& name);
    /// Takes `name VALUE`; `otherwise` if it is not there.
    [[nodiscard]] std::string value(const std::string& name, const std::string& otherwise = {});
    /// @throws WrongWord for a word that nobody took
    void finish(const std::string& usage) const;

private:
    std::vector<std::string> words_;
};

/// @throws WrongWord if the peers are wanted and this build has none
void need_peers_if(bool wanted);
/// A file for results, opened before the long run that makes them; none for an empty name.
/// @throws WrongWord if it cannot be written
[[nodiscard]] std::ofstream open_output(const std::string& name);
/// @throws std::runtime_error if not all of it was written
void close_output(std::ofstream& out, const std::string& name);

}  // namespace palpate::bench
