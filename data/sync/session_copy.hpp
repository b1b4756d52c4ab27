#pragma once

#include "data/sync/session_version.hpp"

namespace palpate::data {

/// Copies a session that `out` does not have, with its study, into it. Its participant is there.
/// @pre its study is what the text says (study_breaks()): so it becomes in `out`
void add_session(const SessionVersion& from, Database& out, const Layout& layout);

/// Brings `own`, a session of `out`, to what it became in `from`. Its rows keep their ids.
/// @pre became(own, from)
void extend_session(const SessionVersion& from,
                    const SessionVersion& own,
                    Database& out,
                    const Layout& layout);

/// The same where `own` did not become `from`: it goes, and its rows get other ids.
void replace_session(const SessionVersion& from,
                     const SessionVersion& own,
                     Database& out,
                     const Layout& layout);

/// Copies what is nobody's in a file: secrets; how traces are written is the same in all.
/// @param file  how to call `from`
/// @throws StoreError where `from` says that they are written otherwise
void copy_shared(Database& from, Database& out, const std::string& file);

/// Copies the one session of `from`, with its participant, into `out`, which does not have it. In
/// the caller's transaction, with deferred foreign keys.
void append_session(Database& from, Database& out, const Layout& layout);

}  // namespace palpate::data
