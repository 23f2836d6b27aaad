#include "server/service/access/keys.h"

#include <openssl/crypto.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "server/base/sha256.h"
#include "server/service/jobs/job_store.h"
#include "server/service/store/data_directory.h"

namespace facetless {
namespace {

constexpr std::string_view kPrefix = "facetless_";
constexpr std::size_t kIdDigits = 16;
constexpr std::size_t kSecretDigits = 64;

constexpr const char* kColumns = "id, name, scopes, rate, quota_mb, created, revoked, digest";

AccessKey ReadKeyRow(const SqlRow& row) {
  AccessKey key;
  key.id = row.Text(0);
  key.name = row.Text(1);
  // The text was written by Create and is well-formed. If the row is damaged, scopes that it does not name
  // are not granted.
  key.read = key.submit = false;
  (void)ParseScopes(row.Text(2), key);
  key.rate = row.Integer(3);
  key.quota_mb = row.Integer(4);
  key.created = row.Real(5);
  key.revoked = row.Real(6);
  return key;
}

}  // namespace

std::string ScopesText(const AccessKey& key) {
  std::string text;
  for (const auto& [given, name] :
       {std::pair{key.read, "read"}, {key.submit, "submit"}, {key.admin, "admin"}}) {
    if (given) text += (text.empty() ? "" : ",") + std::string(name);
  }
  return text;
}

Result<void> ParseScopes(const std::string& text, AccessKey& key) {
  key.read = key.submit = key.admin = false;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    if (name == "read") {
      key.read = true;
    } else if (name == "submit") {
      key.submit = true;
    } else if (name == "admin") {
      key.admin = true;
    } else {
      return Error{ErrorCode::kBadUsage,
                   "there is no scope \"" + name + "\"; the scopes are read, submit and admin"};
    }
    begin = end + 1;
  }
  return {};
}

Result<NewKey> KeyStore::Create(AccessKey key) {
  NewKey made;
  key.id = RandomId().substr(0, kIdDigits);
  key.created = WallClock();
  key.revoked = 0;
  const std::string secret = RandomId() + RandomId();
  auto put = database_.Run(
      "INSERT INTO keys VALUES(?, ?, ?, ?, ?, ?, ?, NULL)",
      {key.id, key.name, Sha256Hex(secret), ScopesText(key), key.rate, key.quota_mb, key.created});
  if (!put) return put.error();
  made.text = std::string(kPrefix) + key.id + "_" + secret;
  made.key = std::move(key);
  return made;
}

Result<std::vector<AccessKey>> KeyStore::List() {
  std::vector<AccessKey> keys;
  const auto asked = database_.Query(std::string("SELECT ") + kColumns + " FROM keys ORDER BY created", {},
                                     [&](const SqlRow& row) { keys.push_back(ReadKeyRow(row)); });
  if (!asked) return asked.error();
  return keys;
}

Result<bool> KeyStore::Revoke(const std::string& id) {
  auto put = database_.Run("UPDATE keys SET revoked = coalesce(revoked, ?) WHERE id = ?", {WallClock(), id});
  if (!put) return put.error();
  return put.value() > 0;
}

std::optional<AccessKey> KeyStore::Verify(const std::string& text) {
  const std::size_t secret = kPrefix.size() + kIdDigits + 1;
  if (text.size() != secret + kSecretDigits || !text.starts_with(kPrefix) || text[secret - 1] != '_')
    return std::nullopt;
  std::optional<AccessKey> key;
  std::string kept(kSecretDigits, '0');
  (void)database_.Query(std::string("SELECT ") + kColumns + " FROM keys WHERE id = ?",
                        {text.substr(kPrefix.size(), kIdDigits)}, [&](const SqlRow& row) {
                          key = ReadKeyRow(row);
                          kept = row.Text(7);
                        });
  // Compare in constant time, wherever the digests differ, and even if there is no such key.
  const std::string given = Sha256Hex(text.substr(secret));
  const bool same =
      kept.size() == given.size() && CRYPTO_memcmp(kept.data(), given.data(), given.size()) == 0;
  if (!same || !key || key->revoked > 0) return std::nullopt;
  return key;
}

}  // namespace facetless
