//! The addresses of the server, and what each answers.

use super::connections::Site;
use super::guard::Guard;
use super::http::{Head, Method, Response, Status};
use super::order;
use super::runs::{Progress, RunError, Runs};
use quadmosaic::page::served_html;
use quadmosaic::pipeline::{Fineness, Options};
use serde::Serialize;
use std::sync::Arc;

/// The page, its runs and its meshes.
pub struct MeshSite {
    pub guard: Guard,
    pub runs: Arc<Runs>,
    /// The options that the server was started with.
    pub options: Options,
    /// The name of the mesh's file where it is saved from the page.
    pub file: String,
}

/// How a run goes, and what the page's form begins with.
#[derive(Serialize)]
struct State {
    #[serde(flatten)]
    progress: Progress,
    /// The number of vertices of the server's options, where they have one.
    points: Option<usize>,
}

impl Site for MeshSite {
    fn admit<'a>(&self, head: &'a Head) -> Result<&'a str, Response> {
        self.guard.admit(head).map_err(|refusal| Response::error(Status::FORBIDDEN, &refusal.to_string()))
    }

    fn answer(&self, method: Method, address: &str, body: &[u8]) -> Response {
        match (method, address) {
            (Method::Get, "") => self.page(),
            (Method::Get, "status") => self.state(Status::OK),
            (Method::Get, "data") => Response::new(Status::OK, "application/json", self.runs.product().page),
            (Method::Get, "mesh") => {
                let file = self.runs.product().file;
                Response::new(Status::OK, "application/octet-stream", file).saved_as(self.file.clone())
            }
            (Method::Post, "run") => self.run(body),
            (Method::Post, "cancel") => {
                self.runs.cancel();
                self.state(Status::OK)
            }
            (_, "" | "status" | "data" | "mesh" | "run" | "cancel") => {
                Response::error(Status::METHOD_NOT_ALLOWED, "this address takes the other one of GET and POST")
            }
            _ => Response::error(Status::NOT_FOUND, "the server has no such address"),
        }
    }
}

impl MeshSite {
    fn page(&self) -> Response {
        let html = served_html(&self.runs.meshing().name, &self.runs.product().page);
        Response::new(Status::OK, "text/html; charset=utf-8", Arc::new(html))
    }

    fn state(&self, status: Status) -> Response {
        let points = match self.options.fineness {
            Fineness::Points(points) => Some(points),
            _ => None,
        };
        Response::json(status, &State { progress: self.runs.progress(), points })
    }

    fn run(&self, body: &[u8]) -> Response {
        let options = match order::options(body, &self.options) {
            Ok(options) => options,
            Err(error) => return Response::error(Status::BAD_REQUEST, &error.to_string()),
        };
        match self.runs.start(options) {
            Ok(()) => self.state(Status::ACCEPTED),
            Err(error @ RunError::Busy) => Response::error(Status::CONFLICT, &error.to_string()),
            Err(error @ RunError::NoThread(_)) => Response::error(Status::UNAVAILABLE, &error.to_string()),
        }
    }
}
