// Keys: who may use the service, and for what.
//
//  1. A key is a text "facetless_<id>_<secret>" that is shown once, when it is made. The secret has 256
//     random bits; kept is its SHA-256, so that whoever reads the database can't come in.
//  2. The id is no secret: it is the owner of what the key makes (store.h, job_store.h), and stands in logs.
//  3. A revoked key is refused from the next request on. What it made stays, for nobody, until it is given
//     up.
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
  bool read = true;                 // look at what is there
  bool submit = true;               // post, and cancel one's own jobs
  bool admin = false;               // look at and cancel everybody's jobs
  std::int64_t rate = 0;            // requests a minute; 0: any number
  std::int64_t quota_mb = 0;        // of what is kept for it; 0: no bound of its own
  double created = 0, revoked = 0;  // seconds since 1970; 0: not revoked
};

struct NewKey {
  AccessKey key;
  std::string text;  // what the user must keep: it cannot be had again
};

class KeyStore {
 public:
  // `database` must outlive it.
  explicit KeyStore(Database& database) : database_(database) {}

  // id and created of `key` are given here. Errors: those of the database.
  Result<NewKey> Create(AccessKey key);
  Result<std::vector<AccessKey>> List();
  // False if there is no such key.
  Result<bool> Revoke(const std::string& id);
  // The key that `text` is; nothing if it is none, or revoked. Takes as long whatever is wrong with the
  // secret.
  std::optional<AccessKey> Verify(const std::string& text);

 private:
  Database& database_;
};

// "read,submit": the names of what it may do. ParseScopes: kBadUsage for other names.
std::string ScopesText(const AccessKey& key);
Result<void> ParseScopes(const std::string& text, AccessKey& key);

// `facetless keys create|list|revoke`: they work while the service runs. Each returns an exit code.
struct KeyArguments {
  std::string directory, name, scopes = "read,submit", id;
  std::int64_t rate = 0, quota_mb = 0;
};
int CreateKeyCommand(const KeyArguments& arguments);
int ListKeysCommand(const KeyArguments& arguments);
int RevokeKeyCommand(const KeyArguments& arguments);

}  // namespace facetless
