// Access keys: the permission to use the service.
//
//     KeyStore keys(database);
//     Result<NewKey> made = keys.Create({.name = "anna"});
//     const std::optional<AccessKey> key = keys.Verify(made.value().text);
//
//  1. A key is a text "facetless_<id>_<secret>" that is shown only when it is made. The secret has 256 random
//     bits. Only its SHA-256 is stored, so read access to the database gives no access to the service.
//  2. The id is not secret. It is the owner of everything that is made with the key (store.h, job_store.h),
//     and appears in logs.
//  3. A revoked key is refused from the next request on. What was made with it stays, accessible to no
//     caller, until the store deletes it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "server/service/store/database.h"

namespace facetless {

struct AccessKey {
  std::string id, name;
  bool read = true;                 // may read models, jobs and answers
  bool submit = true;               // may submit jobs and cancel its own jobs
  bool admin = false;               // may read and cancel the jobs of all owners
  std::int64_t rate = 0;            // requests per minute; 0: no limit
  std::int64_t quota_mb = 0;        // limit of what the store keeps for the key; 0: no limit
  double created = 0, revoked = 0;  // seconds since 1970; 0: not revoked
};

struct NewKey {
  AccessKey key;
  std::string text;  // the key itself, which cannot be shown again
};

class KeyStore {
 public:
  // `database` must outlive this object.
  explicit KeyStore(Database& database) : database_(database) {}

  // Makes a key. The store sets `id` and `created`. Errors: the errors of the database.
  Result<NewKey> Create(AccessKey key);
  Result<std::vector<AccessKey>> List();
  // Revokes a key. Returns false if there is no such key.
  Result<bool> Revoke(const std::string& id);
  // The key with this text; nothing if it is not a valid key, or is revoked. The time does not depend on how
  // the secret is wrong.
  std::optional<AccessKey> Verify(const std::string& text);

 private:
  Database& database_;
};

// The scopes of a key as text, such as "read,submit". ParseScopes returns kBadUsage for unknown names.
std::string ScopesText(const AccessKey& key);
Result<void> ParseScopes(const std::string& text, AccessKey& key);

// `facetless keys create|list|revoke`. The commands work while the service runs. Each returns an exit code.
struct KeyArguments {
  std::string directory, name, scopes = "read,submit", id;
  std::int64_t rate = 0, quota_mb = 0;
};
int CreateKeyCommand(const KeyArguments& arguments);
int ListKeysCommand(const KeyArguments& arguments);
int RevokeKeyCommand(const KeyArguments& arguments);

}  // namespace facetless
