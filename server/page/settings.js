// SPDX-License-Identifier: MIT
// The fields of the form that follow from the engine's table of settings. SETTINGS is the schema of a job's settings, which
// the service puts into the page.

/** Those that index.html has fields for, since they want to know the scene or offer what suits a first look. */
const OWN_FIELDS = ["frames", "fps", "size", "quality", "animation", "camera-node"];
/** Layers that the page shows best. */
const FIRST_LAYERS = ["Z", "N", "id", "tests"];
const TITLES = { spp: "Samples per pixel", error: "Error at most", aov: "Layers" };

function titleOf(name) { return TITLES[name] ?? (name[0].toUpperCase() + name.slice(1)).replaceAll("-", " "); }

function isOfQuality(name) { return Object.values(SETTINGS.quality["x-presets"]).some((preset) => name in preset); }

/** What stands in an empty field: what happens where nothing is said. */
function unsaid(name, schema) { return isOfQuality(name) ? "by quality" : String(schema.default ?? schema["x-syntax"]); }

function labelled(name, schema, field) {
  const unit = schema["x-unit"] ? ` (${schema["x-unit"]})` : "";
  return element("label", { title: schema.description }, `${titleOf(name)}${unit} `, field);
}

function numberField(name, schema, [low, high] = [], step = "any") {
  return element("input", { name, type: "number", min: low ?? "", max: high ?? "", step, placeholder: unsaid(name, schema) });
}

function choiceField(name, schema) {
  const field = element("select", { name }, ...schema.enum.map((value) => element("option", { value, textContent: value })));
  field.value = schema.default ?? field.value;
  return field;
}

/** By the type of a setting: the elements that ask for it. */
const FIELDS = {
  choice: (name, schema) => [labelled(name, schema, choiceField(name, schema))],
  integer: (name, schema) => [labelled(name, schema, numberField(name, schema, schema["x-range"], "1"))],
  number: (name, schema) => [labelled(name, schema, numberField(name, schema, schema["x-range"]))],
  samples: (name, schema) => [labelled(name, schema, numberField(name, schema, schema["x-range"], "1")),
    labelled("error", { ...schema, description: "More samples where the error is larger; then the number of samples is the most that a pixel gets" },
      numberField("error", { "x-syntax": "by quality" }, [0.00001, 1]))],
  flag: (name, schema) => [element("label", { className: "check", title: schema.description },
    element("input", { type: "checkbox", name, checked: schema.default }), ` ${titleOf(name)}`)],
  layers: (name, schema) => [element("fieldset", { className: "layers" }, element("legend", { textContent: titleOf(name) }),
    ...schema.oneOf.at(-1).items.enum.filter((value) => value !== "all").map((value) => element("label", {},
      element("input", { type: "checkbox", name, value, checked: FIRST_LAYERS.includes(value) }), ` ${value}`)))],
};

function textFields(name, schema) {
  return [labelled(name, schema, element("input", { name, autocomplete: "off", placeholder: unsaid(name, schema) }))];
}

function isShown([name, schema]) { return schema["x-visitors"] && !OWN_FIELDS.includes(name); }

/** What the form says of a setting; undefined where that is what happens anyway. */
function valueOf(form, name, schema) {
  const given = form.get(name)?.trim();
  switch (schema["x-type"]) {
    case "flag": return (given !== undefined) === Boolean(schema.default) ? undefined : given !== undefined;
    case "choice": return given === schema.default ? undefined : given;
    case "layers": return form.getAll(name).join(",") || undefined;
    case "samples":
      if (form.get("error")) return ["adaptive", form.get("error"), given].filter(Boolean).join(":");
      return given ? Number(given) : undefined;
    case "integer": case "number": return given ? Number(given) : undefined;
    case "rate": case "number-or-inf": case "name-or-index": return given && !Number.isNaN(Number(given)) ? Number(given) : given || undefined;
    default: return given || undefined;
  }
}

for (const [name, schema] of Object.entries(SETTINGS).filter(isShown))
  $("more-settings").append(...(FIELDS[schema["x-type"]] ?? textFields)(name, schema));
$("new").elements.quality.replaceChildren(...SETTINGS.quality.enum.map((value) => element("option", { value, textContent: titleOf(value) })));
$("new").elements.quality.value = "production";
