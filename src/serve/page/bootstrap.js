// What a first mesh is made of, and how: the words of `bootstrap`.
import { filesOf, freeName, stemOf } from "./things.js";
import { options, split } from "./words.js";

/** Shows the fields that the chosen domain has. */
export function arrange({ elements: { domain, extent, symmetry } }, model) {
  const isOutside = domain.value !== "inside";
  for (const field of [extent, symmetry]) field.closest("label").hidden = !isOutside;
  extent.closest("label").querySelector("span").textContent = domain.value === "sphere" ? "Its radius, in model units" : "Reaches so many times the body's extent";
  extent.placeholder = domain.value === "sphere" ? "" : "10";
  domain.disabled = model?.kind !== "model";
  if (domain.disabled) domain.value = "inside";
}

/** The steps that the form asks for, and what is missing. */
export function steps(form, catalogue, model) {
  if (!model) return { steps: [], missing: "Upload a model first, or choose one." };
  const value = (name) => form.elements[name].value.trim();
  const output = value("output") || freeName(catalogue, stemOf(model.name), "meshb");
  const domain = value("domain");
  const extent = value("extent") || form.elements.extent.placeholder;
  if (domain !== "inside" && !extent) return { steps: [], missing: "Give the radius of the far field." };
  const farField = domain === "inside" ? "" : `${domain}:${extent}`;
  const chosen = { size: value("size"), complexity: value("complexity"), "far-field": farField, symmetry: farField && value("symmetry"), heal: value("heal"), segments: value("segments"), "feature-cells": value("cells") };
  const words = [model.name, "-o", output, ...options(chosen), ...split(value("more")), "--report", stemOf(output) + ".report.json"];
  return { steps: [{ command: "bootstrap", words, files: filesOf(catalogue, model), output }], missing: "" };
}
