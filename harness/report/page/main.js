// ---- The page that this is.
const pages = {run: runPage, sweep: sweepPage, validation: validationPage};
pages[document.documentElement.dataset.kind]();
