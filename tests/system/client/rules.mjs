// The linter's rules for openapi.json: all that Redocly recommends, warnings as errors. Each rule that is off says why.
export const rules = {
  extends: ["recommended-strict"],
  rules: {
    // A page, a health check and this document take nothing that a caller could get wrong. What the transport refuses, of any request, is said
    // once, in info.description.
    "operation-4xx-response": "off",
  },
};
