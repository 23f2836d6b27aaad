#include <cstdio>

#include "server/base/exit_code.h"
#include "server/base/files.h"
#include "server/command/commands.h"
#include "server/service/access/keys.h"
#include "server/service/jobs/answers.h"
#include "server/service/store/data_directory.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

Json KeyJson(const AccessKey& key) {
  return {{"id", key.id},
          {"name", key.name},
          {"scopes", ScopesText(key)},
          {"rate", key.rate},
          {"quota_mb", key.quota_mb},
          {"created", TimeJson(key.created)},
          {"revoked", TimeJson(key.revoked)}};
}

int Print(const Json& json) {
  std::printf("%s\n", JsonText(json).c_str());
  return kExitDone;
}

}  // namespace

int CreateKeyCommand(const KeyArguments& arguments) {
  AccessKey key;
  key.name = arguments.name;
  key.rate = arguments.rate;
  key.quota_mb = arguments.quota_mb;
  if (auto parsed = ParseScopes(arguments.scopes, key); !parsed) return PrintError(parsed.error());
  auto database = DataDirectory::OpenDatabase(arguments.directory);
  if (!database) return PrintError(database.error());
  auto made = KeyStore(*database.value()).Create(key);
  if (!made) return PrintError(made.error());
  Json json = KeyJson(made.value().key);
  json["key"] = made.value().text;
  return Print(json);
}

int ListKeysCommand(const KeyArguments& arguments) {
  auto database = DataDirectory::OpenDatabase(arguments.directory);
  if (!database) return PrintError(database.error());
  auto keys = KeyStore(*database.value()).List();
  if (!keys) return PrintError(keys.error());
  Json list = Json::array();
  for (const AccessKey& key : keys.value()) list.push_back(KeyJson(key));
  return Print(list);
}

int RevokeKeyCommand(const KeyArguments& arguments) {
  auto database = DataDirectory::OpenDatabase(arguments.directory);
  if (!database) return PrintError(database.error());
  auto revoked = KeyStore(*database.value()).Revoke(arguments.id);
  if (!revoked) return PrintError(revoked.error());
  if (!revoked.value()) return PrintError({ErrorCode::kBadUsage, "there is no key " + arguments.id});
  return Print({{"id", arguments.id}, {"revoked", true}});
}

}  // namespace facetless
