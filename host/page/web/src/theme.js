// Light, dark, or as the system is; remembered by the browser.

const KEY = "dermatome-theme";

export function setUpTheme(radios, onChange) {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const apply = (theme) => {
    const isDark = theme === "dark" || (theme === "system" && system.matches);
    document.documentElement.dataset.theme = isDark ? "dark" : "light";
    onChange();
  };
  const chosen = () => radios.find((radio) => radio.checked)?.value ?? "system";
  const remembered = remember();
  for (const radio of radios) {
    radio.checked = radio.value === remembered;
    radio.addEventListener("change", () => apply(remember(chosen())));
  }
  system.addEventListener("change", () => apply(chosen()));
  apply(chosen());
}

// A browser may forbid it.
function remember(theme) {
  try {
    if (theme !== undefined) localStorage.setItem(KEY, theme);
    return theme ?? localStorage.getItem(KEY) ?? "system";
  } catch {
    return theme ?? "system";
  }
}
