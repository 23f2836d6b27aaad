// Which hosts and origins a service answers for: what keeps a page of another site from reading a service on
// its visitor's machine.
//
//  1. Such a page can have its own name resolve to this machine (DNS rebinding); its requests then are
//     same-origin for the browser, and name the page's host. So a request must name a host that this service
//     is known by: an address in numbers, localhost, a name below localhost, or one of the list. A request
//     without a Host is answered: no browser sends one.
//  2. An Origin, where a request has one, must be that of the host that the request names, or one of the
//     list.
//  3. Host names are compared without regard to capitals, a final dot or the port. Origins are compared with
//     their ports.
#pragma once

#include <string>
#include <vector>

namespace facetless {

class HostPolicy {
 public:
  // Answers for everything.
  HostPolicy() = default;
  // `hosts`: names such as "cad.example.org", or "*.example.org" for all names below; "*" for any. `origins`:
  // such as "https://cad.example.org:8443".
  HostPolicy(std::vector<std::string> hosts, std::vector<std::string> origins);

  // Why a request with these headers is refused, as a sentence that names the option to change; empty: it is
  // not.
  std::string WhyNot(const std::string& host, const std::string& origin) const;

 private:
  bool KnowsHost(const std::string& name) const;

  bool any_ = true;
  std::vector<std::string> hosts_, origins_;
};

// The parts of a list "a, b", without blanks around them and without empty ones.
std::vector<std::string> SplitList(const std::string& list);

}  // namespace facetless
