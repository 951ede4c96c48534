//! Table `[inverse]`.

use super::{Checker, beside::TableField, drive::MOST_STEPS};
use crate::skin::{
    Criterion, Hyperparameter, Inverse, Method, Prior, SkinError, Weights,
    file::{InverseTable, NumberOrWord, WeightList},
    table::Columns,
};
use dermatome_shared::patch::Difference;
use serde::Deserialize;
use std::path::Path;

const WEIGHT_FILE: TableField<'_> = TableField {
    field: "inverse.weights",
    else_allowed: "\"steps\", \"reference-squared\", a list",
    columns: Columns { required: &["weight"], optional: &[] },
    most: MOST_STEPS,
};

#[derive(Deserialize)]
struct WeightRow {
    weight: f64,
}

impl Checker<'_> {
    pub(super) fn inverse(&self, table: &InverseTable) -> Result<Inverse, SkinError> {
        let method = self.method(table)?;
        let movement = table.electrode_movement;
        Ok(Inverse {
            method,
            hyperparameter: self.hyperparameter(table)?,
            difference: if table.normalised { Difference::Normalised } else { Difference::Plain },
            weights: self.weights(table)?,
            electrode_movement: movement
                .map(|weight| self.positive_number("inverse.electrode_movement", weight))
                .transpose()?,
            noise_db: self.within("inverse.noise_db", table.noise_db, 60.0, 0.0, 200.0)?,
        })
    }

    fn method(&self, table: &InverseTable) -> Result<Method, SkinError> {
        let method = match (table.method.as_deref(), table.prior.as_deref()) {
            (None | Some("one-step"), Some(prior)) => Method::OneStep(self.prior(prior, table)?),
            (None | Some("one-step"), None) => return self.refuse("inverse.prior", "missing".into(), PRIORS),
            (Some("greit"), None) => Method::Greit {
                radius: self.within("inverse.greit_radius", table.greit_radius, 0.2, 0.01, 1.0)?,
            },
            (Some("greit"), Some(prior)) => {
                return self.refuse(
                    "inverse.prior",
                    format!("{prior:?}"),
                    "nothing (\"greit\" has no prior)",
                );
            }
            (Some(other), _) => {
                return self.refuse("inverse.method", format!("{other:?}"), "\"one-step\" or \"greit\"");
            }
        };
        let only = [
            ("inverse.noser_exponent", table.noser_exponent, "prior \"noser\""),
            ("inverse.gaussian_diameter", table.gaussian_diameter, "prior \"gaussian\""),
            ("inverse.greit_radius", table.greit_radius, "method \"greit\""),
        ];
        let owner = match method {
            Method::OneStep(Prior::Noser { .. }) => "inverse.noser_exponent",
            Method::OneStep(Prior::Gaussian { .. }) => "inverse.gaussian_diameter",
            Method::Greit { .. } => "inverse.greit_radius",
            Method::OneStep(_) => "",
        };
        match only.into_iter().find(|(field, value, _)| value.is_some() && *field != owner) {
            Some((field, value, whose)) => {
                let value = value.unwrap_or_default().to_string();
                self.refuse(field, value, &format!("nothing (only the {whose} has it)"))
            }
            None => Ok(method),
        }
    }

    fn prior(&self, word: &str, table: &InverseTable) -> Result<Prior, SkinError> {
        Ok(match word {
            "laplace" => Prior::Laplace,
            "laplace-squared" => Prior::SquaredLaplace,
            "tikhonov" => Prior::Tikhonov,
            "noser" => Prior::Noser {
                exponent: self.within("inverse.noser_exponent", table.noser_exponent, 0.5, 0.0, 2.0)?,
            },
            "gaussian" => {
                let field = "inverse.gaussian_diameter";
                Prior::Gaussian { diameter: self.within(field, table.gaussian_diameter, 0.1, 0.01, 1.0)? }
            }
            other => return self.refuse("inverse.prior", format!("{other:?}"), PRIORS),
        })
    }

    fn hyperparameter(&self, table: &InverseTable) -> Result<Hyperparameter, SkinError> {
        let criterion = match &table.hyperparameter {
            NumberOrWord::Number(number) => {
                let number = self.positive_number("inverse.hyperparameter", *number)?;
                self.no_noise_figure(table)?;
                return Ok(Hyperparameter::Fixed(number));
            }
            NumberOrWord::Word(word) => word.as_str(),
        };
        if criterion != "noise-figure" {
            self.no_noise_figure(table)?;
        }
        Ok(Hyperparameter::Chosen(match criterion {
            "l-curve" => Criterion::LCurve,
            "gcv" => Criterion::CrossValidation,
            "best-resolution" => Criterion::BestResolution,
            "noise-figure" => Criterion::NoiseFigure(
                self.positive_number("inverse.noise_figure", table.noise_figure.unwrap_or(0.5))?,
            ),
            other => {
                let allowed =
                    "a number above zero, \"l-curve\", \"gcv\", \"noise-figure\" or \"best-resolution\"";
                return self.refuse("inverse.hyperparameter", format!("{other:?}"), allowed);
            }
        }))
    }

    fn no_noise_figure(&self, table: &InverseTable) -> Result<(), SkinError> {
        let allowed = "nothing (only the hyperparameter \"noise-figure\" has it)";
        table
            .noise_figure
            .map_or(Ok(()), |asked| self.refuse("inverse.noise_figure", asked.to_string(), allowed))
    }

    fn weights(&self, table: &InverseTable) -> Result<Weights, SkinError> {
        match &table.weights {
            None => Ok(Weights::Steps),
            Some(WeightList::Word(word)) if word == "steps" => Ok(Weights::Steps),
            Some(WeightList::Word(word)) if word == "reference-squared" => {
                let allowed = "\"steps\" or a list (\"reference-squared\" is for normalised data)";
                if table.normalised {
                    Ok(Weights::ReferenceSquared)
                } else {
                    self.refuse_weights(word, allowed)
                }
            }
            Some(WeightList::Word(file)) => Ok(Weights::Each(self.weight_file(Path::new(file))?)),
            Some(WeightList::Each(list)) => Ok(Weights::Each(list.clone())),
        }
    }

    /// Weights in a CSV file with the one column `weight`.
    fn weight_file(&self, file: &Path) -> Result<Vec<f64>, SkinError> {
        let rows = self.table(file, &WEIGHT_FILE)?;
        Ok(rows.into_iter().map(|row: WeightRow| row.weight).collect())
    }

    fn refuse_weights<T>(&self, value: &str, allowed: &str) -> Result<T, SkinError> {
        self.refuse("inverse.weights", format!("{value:?}"), allowed)
    }

    fn within(
        &self,
        field: &'static str,
        value: Option<f64>,
        default: f64,
        least: f64,
        most: f64,
    ) -> Result<f64, SkinError> {
        match value.unwrap_or(default) {
            value if (least..=most).contains(&value) => Ok(value),
            value => self.refuse(field, value.to_string(), &format!("{least} to {most}")),
        }
    }
}

/// What `inverse.prior` may be.
const PRIORS: &str = "\"laplace\", \"laplace-squared\", \"tikhonov\", \"noser\" or \"gaussian\"";
